from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from active_binocular_vision.baselines import command_search
from active_binocular_vision.baselines.command_search import (
    CommandSearch,
    best_so_far,
    looks_needed,
)
from experiment_manager import Trials
from experiment_manager.measures.trials import trial_names
from lockstep import COMMAND_SPACES, PAIR
from lockstep.command_space import Limits

SPACE = COMMAND_SPACES[PAIR]


class Strategy:
    """Asks for the same two commands in each generation; remembers what it was told."""

    made: "list[Strategy]" = []  # noqa: RUF012

    def __init__(self, place: np.ndarray, sd: float, options: dict[str, Any]) -> None:
        self.place, self.options = place, options
        self.told: list[Any] = []
        Strategy.made.append(self)

    def ask(self) -> list[np.ndarray]:
        return [np.array([0.1, 0.0]), np.array([0.0, 0.1])]

    def tell(self, asked: list[np.ndarray], costs: list[float]) -> None:
        self.told.append((np.array(asked).tolist(), costs))


def test_each_look_answers_the_command_before(monkeypatch):
    Strategy.made.clear()
    package = SimpleNamespace(CMAEvolutionStrategy=Strategy)
    monkeypatch.setattr(command_search, "extra", {"cma": package}.__getitem__)
    search = CommandSearch(SPACE, Limits((0.0, 0.0), (0.2, 0.1)), 1)
    looks = [(0, 0.5), (1, 0.4), (2, 0.3), (3, 0.2), (0, 0.9), (1, 0.8)]
    commands = [
        search(SimpleNamespace(iteration=i, error=e, activations=np.full(12, 0.05)))  # type: ignore[arg-type]
        for i, e in looks
    ]
    first, second = [0.1, 0.0], [0.0, 0.1]
    assert np.array(commands).tolist() == [first, second, first, second, first, second]
    assert search.costs == [[0.5, 0.4, 0.3, 0.2], [0.9, 0.8]]
    one, other = Strategy.made
    assert one.told == [([first, second], [0.4, 0.3])]
    assert other.told == []
    assert one.place.tolist() == [0.05, 0.05]
    assert one.options["bounds"] == [[0.0, 0.0], [0.2, 0.1]]
    assert one.options["seed"] != other.options["seed"]


def test_the_best_place_so_far_is_held():
    errors = np.array([[4.0, 3.0, 2.0, 1.0, 9.0]])
    trials = Trials(
        SPACE,
        0,
        np.zeros(1),
        {"vergence_error_deg": errors},
        np.zeros((1, 5, len(trial_names(SPACE)))),
    )
    costs = np.array([[0.5, 0.2, 0.3, 0.1]])
    held = best_so_far(trials, costs)
    np.testing.assert_array_equal(held.vergence_error_deg, [[4.0, 3.0, 3.0, 1.0]])
    assert held.n_iterations == 3
    first = best_so_far(trials, costs[:, :2])
    assert first.vergence_error_deg.tolist() == [[4.0, 3.0]]
    assert first.n_iterations == 1


@pytest.mark.parametrize(
    ("within", "expected"),
    [([1, 1, 1], 0.0), ([0, 1, 1], 1.0), ([1, 0, 1], 2.0), ([1, 1, 0], np.inf)],
)
def test_looks_count_until_the_eyes_stay(within, expected):
    assert looks_needed(np.array([within], bool)).tolist() == [expected]
