"""Hering's law: how equal the commands to yoked muscles become, which turn both eyes alike."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from experiment_manager.measures.trials import Trials
from lockstep import SIDES, CommandSpace

# Of one eye's muscle and the other eye's that turns it to the same side (Leigh & Zee 2015).
_YOKES = {
    "medial_rectus": "lateral_rectus",
    "superior_rectus": "inferior_oblique",
    "inferior_rectus": "superior_oblique",
}


@dataclass(frozen=True)
class YokedPair:
    """How alike the activations of two yoked muscles are in tests.

    names: of both. start_difference, end_difference: medians over the trials of the absolute
    difference of their activations, before the first and after the last iteration. correlation: of
    both after the last iteration, over trials of the same test with the same object distance; nan
    where one of the two does not vary.
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


def yoked_pairs(tests: Sequence[Trials]) -> Iterator[YokedPair]:
    """Yield all yoked muscles that both have a command, each two once.

    tests: of runs that differ in their seeds alone; their trials are pooled.
    """
    if not tests[0].is_of_pair:
        yield from (_yoked(tests, names) for names in yoked_names(tests[0].space))


def shared_change(values: np.ndarray, groups: np.ndarray) -> SharedChange:
    """Return how two series change together around their means in each group.

    values: (2, n); groups: (n,) what is the same in a group and differs between groups.
    """
    around_mean = values.astype(np.float64)
    for group in np.unique(groups):
        chosen = groups == group
        around_mean[:, chosen] -= around_mean[:, chosen].mean(axis=1, keepdims=True)
    # What is left of equal values is rounding.
    varies = (around_mean**2).sum(axis=1) > np.finfo(np.float64).eps * (values**2).sum(axis=1)
    first, second = np.where(varies[:, None], around_mean, 0.0)
    of_first, of_both = (first**2).sum(), (first * second).sum()
    scale = np.sqrt(of_first * (second**2).sum())
    return SharedChange(
        correlation=float(of_both / scale) if scale else np.nan,
        slope=float(of_both / of_first) if of_first else np.nan,
    )


def _yoked(tests: Sequence[Trials], names: tuple[str, str]) -> YokedPair:
    values = np.concatenate(
        [np.stack([trials.column(name)[:, [0, -1]] for name in names]) for trials in tests], axis=1
    )
    # Each run has means of its own: eyes whose gaze is free end in different places.
    places = [(i, distance) for i, t in enumerate(tests) for distance in t.object_distance_m]
    groups = np.unique(places, axis=0, return_inverse=True)[1]
    start, end = np.median(np.abs(values[0] - values[1]), axis=0)
    correlation = shared_change(values[:, :, 1], groups).correlation
    return YokedPair(names, float(start), float(end), correlation)
