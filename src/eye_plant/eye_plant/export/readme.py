"""The README of the exported files, with what plain MuJoCo makes of them against the plant."""

from collections.abc import Mapping
from itertools import product
from pathlib import Path

import mujoco
import numpy as np

from eye_plant.export.mjcf import KEYFRAME
from eye_plant.mechanics.model import PARAMETER_SETS, MechanicsConfig
from eye_plant.mechanics.oculomotor import Oculomotor

_TEMPLATE = Path(__file__).with_name("README.template.md")
# The activations of the paper's experiments, in steps of a fifth.
_PAIRS = list(product(np.linspace(0.0, 0.2, 6), np.linspace(0.0, 0.1, 6)))
_LONG_S = 10.0


def readme(texts: Mapping[str, str]) -> str:
    """Return the README's text; texts: the exported MJCF by parameter set, which is measured."""
    muscles = {name: parameters.muscles for name, parameters in PARAMETER_SETS.items()}
    names = list(next(iter(muscles.values())))
    return _TEMPLATE.read_text().format(
        version=mujoco.__version__,
        keyframe=KEYFRAME,
        long_s=_LONG_S,
        fast=PARAMETER_SETS["anatomical"].energetics.fast_fraction,
        differences="\n".join(_row_of_differences(*item) for item in texts.items()),
        muscles=" | ".join(name.replace("_", " ") for name in names),
        rules="|".join("---" for _ in names),
        masses="\n".join(
            f"| {name} | " + " | ".join(f"{1e3 * of_set[m].mass_kg:.2f}" for m in names) + " |"
            for name, of_set in muscles.items()
        ),
    )


def _row_of_differences(parameter_set: str, mjcf: str) -> str:
    eyes = Oculomotor(MechanicsConfig(parameter_set=parameter_set))
    model = mujoco.MjModel.from_xml_string(mjcf)
    period_s = eyes.config.period_s
    period_deg = _difference_deg(eyes, model, period_s)
    long_deg = _difference_deg(eyes, model, _LONG_S)
    return f"| {parameter_set} | {period_s:g} s | {period_deg:.2g} deg | {long_deg:.2g} deg |"


def _difference_deg(eyes: Oculomotor, model: mujoco.MjModel, duration_s: float) -> float:
    """Return the largest difference of any angle from the plant's equilibrium, over all pairs.

    duration_s: time that plain MuJoCo has from the keyframe on.
    """
    data = mujoco.MjData(model)
    differences_deg = []
    for pair in _PAIRS:
        activations = eyes.activations_from(*pair)
        mujoco.mj_resetDataKeyframe(model, data, 0)
        data.ctrl[:] = activations
        mujoco.mj_step(model, data, round(duration_s / model.opt.timestep))
        eyes.settle(activations)
        differences_deg.append(np.degrees(data.qpos) - np.degrees(eyes.data.qpos))
    return float(np.abs(differences_deg).max())
