"""The pictures on the plane: generated or read from a directory."""
