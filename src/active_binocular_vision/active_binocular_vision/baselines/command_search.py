"""CMA-ES in each scene: a search over commands by what each costs in reconstruction error E.

Nothing is learned from one scene for the next, so each look at a scene counts. CMA-ES over the
weights of our linear actor would have 1,600 to 9,756 of them, and one value an episode.
"""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from active_binocular_vision.baselines.bench import Seen
from active_binocular_vision.baselines.extra import extra
from experiment_manager import Trials
from lockstep import CommandSpace
from lockstep.command_space import Limits

Array = NDArray[np.float64]

# As wide as our exploration begins (D16).
FIRST_SD = np.sqrt(2.5e-4)


class CommandSearch:
    """The controller: what the evolution strategy asks for, one command a look.

    costs: E of each look, (n_looks,), of each trial so far.
    """

    def __init__(self, space: CommandSpace, limits: Limits, seed: int) -> None:
        """limits: of the commands of the space; raises InputError without the package cma."""
        self._cma, self._space, self._seed = extra("cma"), space, seed
        self._bounds = [list(limits.lowest), list(limits.highest)]
        self.costs: list[list[float]] = []
        self._strategy: Any = None
        # Of the present generation: commands, and what the first of them cost.
        self._asked: list[Array] = []
        self._answered: list[float] = []

    def __call__(self, seen: Seen) -> Array:
        """Take what the last command cost, and return the next one (n_commands,)."""
        if seen.iteration == 0:
            self._begin(self._space.from_all(seen.activations))
        else:
            self._answered.append(seen.error)
        self.costs[-1].append(seen.error)
        if len(self._answered) == len(self._asked):
            if self._asked:
                self._strategy.tell(self._asked, self._answered)
            self._asked, self._answered = self._strategy.ask(), []
        return np.array(self._asked[len(self._answered)])

    def _begin(self, place: Array) -> None:
        self.costs.append([])
        options = {"bounds": self._bounds, "verbose": -9, "seed": self._seed + len(self.costs)}
        self._strategy = self._cma.CMAEvolutionStrategy(place, FIRST_SD, options)
        self._asked, self._answered = [], []


def best_so_far(trials: Trials, costs: Array) -> Trials:
    """Return trials in which the eyes hold, after each look, the best place that they have seen.

    costs: (n_trials, n_looks + 1) of the places where each iteration began, as many as are kept.
    """
    best = np.array([[int(np.argmin(c[: k + 1])) for k in range(len(c))] for c in costs])
    columns = {
        name: np.take_along_axis(of_trials, best, axis=1)
        for name, of_trials in trials.columns.items()
    }
    return replace(trials, columns=columns, rows=trials.rows[:, : best.shape[1]])


def looks_needed(is_within: NDArray[np.bool_]) -> Array:
    """Return after how many looks the eyes stay within a pixel, (n_trials,), inf for never.

    is_within: (n_trials, n_looks + 1), at the start and after each look.
    """
    n = is_within.shape[1]
    since = n - np.argmin(is_within[:, ::-1], axis=1).astype(float)
    since[is_within.all(axis=1)] = 0.0
    return np.where(is_within[:, -1], since, np.inf)
