"""Learners of a checkpoint that learn no more: tested on pictures, and examined as in a clinic."""
