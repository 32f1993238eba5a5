"""Disturbs runs on purpose: torture.sh."""
