"""Draws both eyes with their twelve muscles as they look at a near object, up and to their left.

usage: .venv/bin/python docs/examples/draw_eyes.py PNG
"""

import sys
from pathlib import Path

import numpy as np

from active_binocular_vision.figures.eyes import DrawnEyes
from active_binocular_vision.figures.style import GREY, WIDTH_IN, new_figure, own_style, save
from eye_plant.inverse.gaze import GazeInverse
from eye_plant.mechanics.mujoco_model import MechanicsConfig
from eye_plant.mechanics.oculomotor import Oculomotor
from lockstep import MUSCLE_NAMES, CommandSpace

DISTANCE_M = 0.25
GAZE_DEG = {
    "horizontal": 0.0,
    "vertical": 0.0,
    "torsional": 0.0,
    "version": -12.0,
    "elevation": 6.0,
}
# Of the left eye: where a name stands and what it points at, mm from the middle of the eyes.
NAMES = {
    "superior rectus": ((38.0, 23.5), (26.5, 14.5)),
    "lateral rectus": ((39.0, 15.5), (40.0, 5.0)),
    "inferior rectus": ((39.0, -19.0), (29.0, -12.8)),
    "superior oblique": ((1.0, 24.0), (11.3, 17.0)),
    "medial rectus": ((0.0, 3.0), (14.0, 1.0)),
    "inferior oblique": ((0.0, -6.5), (18.5, -15.5)),
}


def main() -> None:
    """Draw the eyes with the cheapest activations that have this gaze."""
    config = MechanicsConfig(parameter_set="anatomical")
    space = CommandSpace(MUSCLE_NAMES)
    inverse = GazeInverse(config, space, np.zeros(12), np.full(12, 0.3))
    activations = inverse.least(GAZE_DEG, DISTANCE_M).activations
    plant = Oculomotor(config)
    plant.settle(activations)
    with own_style():
        figure = new_figure(WIDTH_IN, 3.8)
        eyes = DrawnEyes(figure.add_subplot(), config, float(activations.max()))
        figure.draw_without_rendering()
        eyes.show(plant.state().eye_angles_rad.ravel(), activations)
        eyes.describe()
        for name, (at_mm, tip_mm) in NAMES.items():
            eyes.axes.annotate(
                name,
                tip_mm,
                at_mm,
                va="center",
                ha="center",
                color=GREY,
                arrowprops={"arrowstyle": "-", "color": GREY, "lw": 0.8},
                zorder=5,
            )
        save(figure, Path(sys.argv[1]))


if __name__ == "__main__":
    main()
