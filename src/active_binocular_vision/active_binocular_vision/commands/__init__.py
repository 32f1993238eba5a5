"""What the commands of `abv` do, and what these share."""
