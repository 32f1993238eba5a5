"""The mechanics of the eyes: muscles, globe, equilibria and metabolic rate."""

import eye_plant.libraries  # noqa: F401 (checks them, before anything is imported from them)
