"""What a process asks of its machine and settles with it: domain, signals, cores."""
