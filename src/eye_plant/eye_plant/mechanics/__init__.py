"""The mechanics of the eyes: muscles, globe, equilibria and metabolic rate."""
