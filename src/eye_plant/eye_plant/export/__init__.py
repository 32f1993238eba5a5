"""The eyes as MJCF, for programs that know nothing of this project."""
