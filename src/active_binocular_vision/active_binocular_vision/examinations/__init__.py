"""Frozen learners examined as in an eye clinic: cover test, prisms, acuity and stereo vision."""
