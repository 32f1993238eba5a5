"""Hering's law: how equal the commands to yoked muscles become, which turn both eyes alike."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from experiment_manager.measures.trials import Trials
from lockstep.command_space import SIDES, CommandSpace

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


@dataclass(frozen=True)
class SharedChange:
    """How the second of two series changes with the first; nan where one does not vary.

    slope: of the second on the first, by least squares.
    """

    correlation: float
    slope: float


def yoked_names(space: CommandSpace) -> list[tuple[str, str]]:
    """Return the names of yoked muscles that both have a command, each two once."""
    pairs = [
        (f"{side}_{muscle}", f"{other}_{yoke}")
        for side, other in (SIDES, SIDES[::-1])
        for muscle, yoke in _YOKES.items()
    ]
    return [pair for pair in pairs if set(pair) <= set(space.names)]


def yoked_pairs(trials: Trials) -> Iterator[YokedPair]:
    """Yield all yoked muscles that both have a command, each two once."""
    if not trials.is_of_pair:
        yield from (_yoked(trials, names) for names in yoked_names(trials.space))


def shared_change(values: np.ndarray, distance_m: np.ndarray) -> SharedChange:
    """Return how two series change together around their means at each distance.

    values: (2, n); distance_m: (n,).
    """
    around_mean = values.astype(np.float64)
    for distance in np.unique(distance_m):
        chosen = distance_m == distance
        around_mean[:, chosen] -= around_mean[:, chosen].mean(axis=1, keepdims=True)
    first, second = around_mean
    of_first, of_both = (first**2).sum(), (first * second).sum()
    scale = np.sqrt(of_first * (second**2).sum())
    return SharedChange(
        correlation=float(of_both / scale) if scale else np.nan,
        slope=float(of_both / of_first) if of_first else np.nan,
    )


def _yoked(trials: Trials, names: tuple[str, str]) -> YokedPair:
    values = np.stack([trials.column(name)[:, [0, -1]] for name in names])
    start, end = np.median(np.abs(values[0] - values[1]), axis=0)
    correlation = shared_change(values[:, :, 1], trials.object_distance_m).correlation
    return YokedPair(names, float(start), float(end), correlation)
