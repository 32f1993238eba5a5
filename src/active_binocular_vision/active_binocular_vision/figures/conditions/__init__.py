"""Figures of conditions side by side."""
