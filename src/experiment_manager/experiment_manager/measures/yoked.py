"""Hering's law: how equal the commands to yoked muscles become, which turn both eyes alike."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from experiment_manager.measures.trials import Trials
from lockstep.command_space import SIDES

# Of one eye's muscle and the other eye's that turns it to the same side (Leigh & Zee 2015).
_YOKES = {
    "medial_rectus": "lateral_rectus",
    "superior_rectus": "inferior_oblique",
    "inferior_rectus": "superior_oblique",
}


@dataclass(frozen=True)
class YokedPair:
    """How alike the activations of two yoked muscles are in a test.

    names: of both. start_difference, end_difference: medians over the trials of the absolute
    difference of their activations, before the first and after the last iteration. correlation: of
    both after the last iteration, over trials with the same object distance; nan where one of the
    two does not vary.
    """

    names: tuple[str, str]
    start_difference: float
    end_difference: float
    correlation: float


def yoked_pairs(trials: Trials) -> Iterator[YokedPair]:
    """Yield all yoked muscles that both have a command, each two once."""
    if trials.is_of_pair:
        return
    for side, other in (SIDES, SIDES[::-1]):
        for muscle, yoke in _YOKES.items():
            names = f"{side}_{muscle}", f"{other}_{yoke}"
            if set(names) <= set(trials.space.names):
                yield _yoked(trials, names)


def _yoked(trials: Trials, names: tuple[str, str]) -> YokedPair:
    values = np.stack([trials.column(name)[:, [0, -1]] for name in names])
    start, end = np.median(np.abs(values[0] - values[1]), axis=0)
    around_mean = values[:, :, 1].copy()
    for distance_m in np.unique(trials.object_distance_m):
        chosen = trials.object_distance_m == distance_m
        around_mean[:, chosen] -= around_mean[:, chosen].mean(axis=1, keepdims=True)
    first, second = around_mean
    scale = np.sqrt((first**2).sum() * (second**2).sum())
    correlation = (first * second).sum() / scale if scale else np.nan
    return YokedPair(names, float(start), float(end), float(correlation))
