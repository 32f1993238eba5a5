"""Examinations of eyes with lenses: what they focus on, and what links lenses and vergence."""
