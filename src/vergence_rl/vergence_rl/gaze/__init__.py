"""Saccades to a place that is seen, and vergence that leaves the gaze there (D22)."""
