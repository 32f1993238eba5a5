"""What a run is: its settings, its episodes and trials, what changes in its course."""
