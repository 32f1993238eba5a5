"""Figures of examinations."""
