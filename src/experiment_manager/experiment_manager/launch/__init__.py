"""From a command line to running processes: configuration, domains, supervisor."""
