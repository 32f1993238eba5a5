"""A robot's head in the place of the eyes."""
