"""What the dictionaries have learned: reward over vergence, tuning of basis functions."""
