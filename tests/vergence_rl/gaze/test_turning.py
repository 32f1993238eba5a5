"""A rule that turns the eyes: in which units it is told of turns, and asks for them."""

import dataclasses
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vergence_rl import Decision
from vergence_rl.gaze.config import GazeConfig
from vergence_rl.gaze.control import GazeControl
from vergence_rl.gaze.turning import TurningRule
from vergence_rl.learning_rule import TimeStep

WANTED = np.array([0.3, -0.2, 0.1])


class _Rule:
    """Asks for the same turn each time, and remembers where it was told that the eyes are."""

    def __init__(self) -> None:
        self.places: list[NDArray[np.float64]] = []

    def step(
        self, observation: TimeStep, *, learning: bool, draw: np.random.Generator | None
    ) -> Decision:
        self.places.append(observation.activations)
        place = observation.activations + WANTED
        return Decision(place, WANTED, 0.0, 0.0, 0.0, 0.0, 0.0)

    def state(self) -> dict[str, NDArray[Any]]:
        return {}

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        pass


class _Control(GazeControl):
    """Remembers which turns of vergence it was asked for."""

    def __init__(self) -> None:
        super().__init__(np.zeros(12), np.ones(12), GazeConfig(), holds_gaze=True)
        self.asked_deg: list[NDArray[np.float64]] = []

    def verge(
        self, activations: NDArray[np.float64], turn_deg: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        self.asked_deg.append(turn_deg)
        return activations


def test_a_degree_of_torsion_counts_as_its_weight_says() -> None:
    rule, control = _Rule(), _Control()
    turning = TurningRule(rule, control, 4, 1, torsion_weight=0.25)
    step = TimeStep(0, 0, np.ones(1), np.full(12, 0.1), -0.1)
    for i in range(3):
        turning.step(dataclasses.replace(step, iteration=i), learning=False, draw=None)
    np.testing.assert_allclose(control.asked_deg, [[0.3, -0.2, 0.4]] * 3)
    # Of the first visit and the next: by then the eyes have turned once.
    np.testing.assert_allclose(rule.places[1:], [np.zeros(3), WANTED])
