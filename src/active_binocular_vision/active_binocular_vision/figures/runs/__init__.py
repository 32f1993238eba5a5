"""Figures of training and tests."""
