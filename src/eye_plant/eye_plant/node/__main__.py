"""What `python -m eye_plant.node` runs."""

from eye_plant.node import main

main()
