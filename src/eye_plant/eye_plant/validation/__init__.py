"""Published values of eyes and muscles, and the same measured on both parameter sets."""
