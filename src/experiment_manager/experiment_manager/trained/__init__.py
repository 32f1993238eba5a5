"""Trained eyes that come with the package, by the names of their profiles."""
