"""Draws the errors over training that gymnasium_sac.py and gymnasium_scores.py have written.

Both tables are in results/gymnasium, with the scores after training.

usage: .venv/bin/python docs/examples/gymnasium_curves.py PNG
"""

import sys
from pathlib import Path

import numpy as np

from active_binocular_vision.figures.style import (
    BLUE,
    VERMILION,
    label_decades,
    mark_level,
    new_figure,
    own_style,
    save,
)
from eye_plant.vergence import degrees_per_px
from lockstep.optics import OpticsConfig

MEASURED = Path(__file__).parents[2] / "results" / "gymnasium"
FOCAL_LENGTH_PX = OpticsConfig().focal_length_px
CURVES = (
    ("SAC", "sac_curve.csv", VERMILION, "D"),
    ("hindsight regression", "hindsight_curve.csv", BLUE, "o"),
)


def main() -> None:
    """Draw a line for each agent, and its score in tests at the end."""
    scores = (MEASURED / "scores.txt").read_text().splitlines()
    with own_style():
        figure = new_figure(6.0, 3.0)
        axes = figure.add_subplot()
        for name, table, colour, marker in CURVES:
            step, error_deg = np.loadtxt(MEASURED / table, delimiter=",", skiprows=1).T
            axes.plot(step, error_deg, color=colour, label=f"{name}, training, n = 1 seed")
            row = next(line for line in scores if line.startswith(name.split()[0]))
            tested_deg = float(row.split("steps")[1].split()[0])
            label = f"{name}, test at the end"
            axes.plot(step[-1], tested_deg, marker, color=colour, ms=6, label=label, clip_on=False)
        label_decades(axes)
        mark_level(axes, degrees_per_px(FOCAL_LENGTH_PX), "1 px")
        axes.set(xlabel="steps", ylabel="|vergence error| / deg", xlim=(0, None))
        axes.legend()
        save(figure, Path(sys.argv[1]))


if __name__ == "__main__":
    main()
