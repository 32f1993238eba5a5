"""A run in one process, without nodes."""
