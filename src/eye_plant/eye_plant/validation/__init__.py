"""Published values of eyes and muscles, and the same measured on both parameter sets."""

import os

# Names a file with OpenEyeSim's maps.
MAPS_VARIABLE = "ABV_OPENEYESIM_MAPS"

# The figure is a file. A notebook's kernel names a backend that matplotlib may not find here.
os.environ["MPLBACKEND"] = "agg"
