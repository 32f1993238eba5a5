"""The options of the commands: here nothing is imported that keeps somebody waiting for --help."""
