"""Learned saccades simulated over time: amplitude, peak velocity, duration."""
