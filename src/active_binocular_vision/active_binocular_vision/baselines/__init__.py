"""Other methods in the same test as a run's own learners."""
