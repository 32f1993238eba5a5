"""From a command line to the configuration of a run, and its continuation with another one."""
