"""The README that goes with the exported files."""

from collections.abc import Mapping
from pathlib import Path

import mujoco

from eye_plant.export.comparison import LONG_S, Difference
from eye_plant.export.mjcf import KEYFRAME
from eye_plant.mechanics.parameter_sets import PARAMETER_SETS

_TEMPLATE = Path(__file__).with_name("README.template.md")


def readme(differences: Mapping[str, Difference]) -> str:
    """Return the README's text; differences: measured, by parameter set."""
    muscles = {name: parameters.muscles for name, parameters in PARAMETER_SETS.items()}
    names = list(next(iter(muscles.values())))
    return _TEMPLATE.read_text().format(
        version=mujoco.__version__,
        keyframe=KEYFRAME,
        long_s=LONG_S,
        fast=PARAMETER_SETS["anatomical"].energetics.fast_fraction,
        differences="\n".join(
            f"| {name} | {found.period_s:g} s | {found.after_period_deg:.2g} deg "
            f"| {found.after_long_deg:.2g} deg |"
            for name, found in differences.items()
        ),
        muscles=" | ".join(name.replace("_", " ") for name in names),
        rules="|".join("---" for _ in names),
        masses="\n".join(
            f"| {name} | " + " | ".join(f"{1e3 * of_set[m].mass_kg:.2f}" for m in names) + " |"
            for name, of_set in muscles.items()
        ),
    )
