"""Runs that were read: one, and groups of them."""
