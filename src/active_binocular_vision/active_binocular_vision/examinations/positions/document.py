"""What eyes did at the nine positions, as evaluate.sh writes and prints it."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from active_binocular_vision.examinations.positions.examination import Examined, Gazes, examine
from active_binocular_vision.examinations.positions.measures import (
    Planes,
    planes_of_eyes,
    planes_of_optimum,
    silences_of,
    yoked_changes,
)
from active_binocular_vision.examinations.positions.posture import ERROR_AXES
from active_binocular_vision.examinations.positions.text import tables
from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.shown import OWN_TEST_STIMULI, Shown
from experiment_manager.measures.yoked import SharedChange
from lockstep import SIDES

SUMMARISED = ("missed_deg", *(f"{axis}_error_deg" for axis in ERROR_AXES), "metabolic_rate_w")


@dataclass(frozen=True)
class NinePositions:
    """An examination that was made."""

    examined: Examined

    @cached_property
    def _document(self) -> dict[str, Any]:
        return document(self.examined)

    def to_json(self) -> dict[str, Any]:
        """Return what evaluate.sh writes."""
        return self._document

    def table(self) -> str:
        """Return the tables as text."""
        return tables(self._document)


def examine_positions(
    learners: FrozenLearners, shown: Shown = OWN_TEST_STIMULI, covered: str = ""
) -> NinePositions:
    """Make the examination; covered, errors: as `examine` has them."""
    return NinePositions(examine(learners, shown, covered))


def document(examined: Examined) -> dict[str, Any]:
    """Return what evaluate.sh writes; docs/gaze.md says what it is."""
    random = examined.random
    positions = list(gaze_entries(examined.nine))
    return examined.learners.said() | {
        "examination": "nine-positions",
        "stimuli": examined.stimuli,
        "n_stimuli": examined.n_pictures,
        "n_iterations": examined.n_iterations,
        "covered": examined.covered,
        "summary": summary(positions),
        "positions": positions,
        "random": list(gaze_entries(random)),
        "antagonists": {name: vars(s) for name, s in silences_of(examined).items()},
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


def gaze_entries(gazes: Gazes) -> Iterator[dict[str, Any]]:
    """Yield an entry for each distance and target.

    learned: medians over pictures; least: with the least energy, None for a gaze that the muscles
    do not reach; cost_ratio: C of both; looks: with each picture.
    """
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
                "wanted_gaze_deg": dict(
                    zip(SIDES, gazes.wanted_gaze_deg[at].tolist(), strict=True)
                ),
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


def summary(entries: Sequence[Mapping[str, Any]]) -> dict[str, dict[str, float | None]]:
    """Return medians of absolute values by distance in m, and over "all".

    Errors and C over all looks; the least C and the ratio of both over positions with a least C.
    """
    by_distance: dict[str, list[Mapping[str, Any]]] = {}
    for entry in entries:
        by_distance.setdefault(f"{entry['object_distance_m']:g}", []).append(entry)
    return {name: _medians(of) for name, of in (by_distance | {"all": [*entries]}).items()}


def _medians(entries: Sequence[Mapping[str, Any]]) -> dict[str, float | None]:
    looks = [look for entry in entries for look in entry["looks"]]
    reached = [entry for entry in entries if entry["least"]]
    values = {name: [abs(look[name]) for look in looks] for name in SUMMARISED}
    values["least_metabolic_rate_w"] = [entry["least"]["metabolic_rate_w"] for entry in reached]
    values["cost_ratio"] = [entry["cost_ratio"] for entry in reached]
    return {name: float(np.median(of)) if of else None for name, of in values.items()}


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
