"""Binocular sparse coding by matching pursuit: features and reward."""
