"""What a person sees of a run on a terminal, or reads in a log."""
