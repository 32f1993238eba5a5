"""The scripts of launch_scripts that users call, and what these share."""
