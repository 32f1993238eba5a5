"""Published values of eyes and muscles, and the same measured on both parameter sets."""

# Names a file with OpenEyeSim's maps.
MAPS_VARIABLE = "ABV_OPENEYESIM_MAPS"
