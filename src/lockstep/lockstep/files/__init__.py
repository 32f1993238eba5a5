"""Files that last, that are mapped or locked, and those of learners' states."""
