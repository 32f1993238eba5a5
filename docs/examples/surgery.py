"""Draws how far surgery of one muscle turns an eye at the tonic level, beside what patients have.

usage: .venv/bin/python docs/examples/surgery.py FILE.png
"""

import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from active_binocular_vision.figures.style import BLUE, GREY, VERMILION, WIDTH_IN, own_style
from eye_plant.mechanics.mujoco_model import MechanicsConfig
from eye_plant.mechanics.oculomotor import Oculomotor
from lockstep import MUSCLE_NAMES

DOSES_MM = np.arange(0.0, 8.5, 1.0)
# Name, muscle, sign of recession_mm, and patients: mm, PD, least and greatest or none, and whose.
# Zak 1986 (doi 10.3928/0191-3913-19860101-05): 53 patients. Lateral: means of 38 patients after an
# earlier recession (aao.org/editors-choice/bilateral-surgery-recommended-residual-esotropia-g).
OPERATIONS = (
    ("medial rectus, recession", "medial_rectus", 1.0, [6.0], [16.0], [[3.0], [6.0]]),
    ("lateral rectus, resection", "lateral_rectus", -1.0, [4.0, 7.0], [10.5, 14.9], None),
)
# PD per mm: what Parks recommends, as cited in doi 10.1001/archophthalmol.2012.1389.
PARKS = {"medial_rectus": 5.0, "lateral_rectus": 2.5}


def outward_pd(muscle: str, recession_mm: float, tissue_stiffness: float) -> float:
    """Return how far the right eye turns out, in prism dioptres."""
    doses = tuple(recession_mm if name == f"right_{muscle}" else 0.0 for name in MUSCLE_NAMES)
    eyes = Oculomotor(
        MechanicsConfig(
            parameter_set="anatomical", recession_mm=doses, tissue_stiffness=tissue_stiffness
        )
    )
    eyes.rest(eyes.tonic_activations)
    return -100.0 * float(np.tan(eyes.state().eye_angles_rad[1, 0]))


def main() -> None:
    """Draw both operations."""
    with own_style():
        figure = Figure(figsize=(WIDTH_IN, 0.4 * WIDTH_IN), layout="constrained")
        panels = figure.subplots(1, 2, sharey=True)
        for axes, (title, muscle, sign, mm, pd, spread) in zip(panels, OPERATIONS, strict=True):
            for stiffness, color in ((1.0, BLUE), (0.5, VERMILION)):
                turned = [outward_pd(muscle, sign * dose, stiffness) for dose in DOSES_MM]
                axes.plot(DOSES_MM, turned, color=color, label=f"tissue_stiffness {stiffness}")
                print(title, stiffness, np.round(turned, 1))
            axes.errorbar(mm, pd, yerr=spread, fmt="ko", ms=4, label="patients")
            through = pd[0] + PARKS[muscle] * (DOSES_MM - mm[0])
            axes.plot(DOSES_MM, through, color=GREY, ls=":", label="slope of Parks' table")
            axes.set(title=title, xlabel="mm", ylim=(0.0, 30.0))
        panels[0].set_ylabel("turned out / PD")
        panels[0].legend()
        figure.savefig(Path(sys.argv[1]))


if __name__ == "__main__":
    main()
