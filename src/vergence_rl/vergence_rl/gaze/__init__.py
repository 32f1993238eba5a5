"""Turns of the eyes: saccades to what is seen, and vergence for little energy (D22, D23)."""
