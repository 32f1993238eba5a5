"""The document of the nine positions, with the numbers of all looks."""

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from experiment_manager.measures.yoked import SharedChange
from experiment_manager.positions.examination import Examined, Gazes
from experiment_manager.positions.measures import (
    Planes,
    planes_of_eyes,
    planes_of_optimum,
    silences_of,
    yoked_changes,
)
from lockstep.command_space import SIDES

Readings = dict[str, NDArray[np.float64]]


def document(examined: Examined) -> dict[str, Any]:
    """Return what evaluate.sh writes; docs/gaze.md says what it is."""
    random = examined.random
    return examined.learners.said() | {
        "examination": "nine positions",
        "stimuli": examined.stimuli,
        "n_stimuli": examined.n_pictures,
        "n_iterations": examined.n_iterations,
        "covered": examined.covered,
        "positions": list(gaze_entries(examined.nine, examined.positions_m)),
        "random": list(gaze_entries(random, examined.positions_m)),
        "antagonists": {name: s.to_json() for name, s in silences_of(examined).items()},
        "listing": {
            name: _listing(planes)
            for name, planes in (
                ("learned", planes_of_eyes(examined)),
                ("least", planes_of_optimum(examined)),
            )
        },
        "yoked": {
            name: _yoked(yoked_changes(posture, random.distances_m))
            for name, posture in (("learned", random.eyes), ("least", random.optimum))
        },
    }


def gaze_entries(gazes: Gazes, positions_m: NDArray[np.float64]) -> Iterator[dict[str, Any]]:
    """Yield an entry for each distance and target.

    learned: medians over pictures; least: with the least energy, None for a gaze that the muscles
    do not reach; cost_ratio: C of both; looks: with each picture.
    """
    wanted_deg = gazes.wanted_gaze_deg(positions_m)
    looks, least = gazes.eyes.readings(), gazes.optimum.readings()
    for i_distance, distance_m in enumerate(gazes.distances_m):
        for i, target_deg in enumerate(gazes.targets_deg.tolist()):
            at = i_distance, i
            learned = {name: float(np.median(values[at])) for name, values in looks.items()}
            of_least = {name: float(values[at]) for name, values in least.items()}
            is_reached = math.isfinite(of_least["metabolic_rate_w"])
            yield {
                "object_distance_m": distance_m,
                "target_deg": target_deg,
                "wanted_gaze_deg": dict(zip(SIDES, wanted_deg[at].tolist(), strict=True)),
                "learned": learned,
                "least": of_least if is_reached else None,
                "cost_ratio": (
                    learned["metabolic_rate_w"] / of_least["metabolic_rate_w"]
                    if is_reached
                    else None
                ),
                "looks": [
                    {"stimulus": stimulus}
                    | {name: float(values[(*at, k)]) for name, values in looks.items()}
                    for k, stimulus in enumerate(gazes.pictures[i].tolist())
                ],
            }


def _listing(planes: Mapping[str, Planes]) -> dict[str, Any]:
    tilts = [of_eye.tilt_per_vergence for of_eye in planes.values()]
    known = [tilt for tilt in tilts if tilt is not None]
    mean = sum(known) / len(known) if len(known) == len(SIDES) else None
    of_eyes = {side: of_eye.to_json() for side, of_eye in planes.items()}
    return of_eyes | {"mean_tilt_per_vergence": mean}


def _yoked(changes: dict[str, SharedChange]) -> dict[str, dict[str, float | None]]:
    return {
        pair: {
            name: value if math.isfinite(value) else None for name, value in vars(change).items()
        }
        for pair, change in changes.items()
    }
