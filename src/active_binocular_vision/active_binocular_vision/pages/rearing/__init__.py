"""Altered rearing: its conditions, and what becomes of dictionary and reward in them."""
