"""Finished runs, what they have in common, and what stays of them."""
