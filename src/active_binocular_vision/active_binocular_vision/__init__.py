"""What people import and command: what is done with runs and their learners."""
