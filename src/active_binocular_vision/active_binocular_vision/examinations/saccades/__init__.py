"""First saccades, simulated over time."""
