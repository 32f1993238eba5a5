"""Figures of a report, one idea a file."""
