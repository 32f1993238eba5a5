"""What the commands of `abv` do, and what these share."""

import os

# Figures are files. A notebook's kernel names a backend that matplotlib may not find here.
os.environ["MPLBACKEND"] = "agg"
