"""The supervisor's own node, in a process that may hang or die without it."""
