"""From what is asked of a run to its configuration, and to its continuation with another one."""
