"""The measures of K17: vergence error and metabolic cost after 1, 2, 3 and 20 iterations of a test.

C is the metabolic rate, C_0 that at the start of a trial, C* the least one with correct gaze.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from lockstep.errors import InputError
from lockstep.topics import GROUND_TRUTH_NAMES, TEST

# K17 Fig. 3 shows these; the last one is what all tables report.
REPORTED_ITERATIONS = (1, 2, 3, 20)
# K17's share of the cost in the reward is told over so many iterations at either end of training.
SHARE_ITERATIONS = 5000
# Trials start at whole degrees of error; the eyes settle within 0.02 deg.
_ZERO_ERROR_DEG = 0.1
# Where the start costs what the optimum costs, the share saved (eq. 8) divides by nothing.
LEAST_COST_RANGE_W = 0.01

_COLUMN = {name: i for i, name in enumerate(GROUND_TRUTH_NAMES)}


@dataclass(frozen=True)
class TestTrials:
    """All trials of one test, by trial number.

    n_iterations is that of each trial; iteration 0 is the start, before the first command.
    vergence_error_deg, metabolic_rate_w: (n_trials, n_iterations + 1); optimal_metabolic_rate_w,
    object_distance_m, stimulus, trial: (n_trials,); rows: the rows of the table that the
    trials came from, (n_trials, n_iterations + 1).
    """

    __test__ = False  # the name is K17's; pytest need not collect it

    training_iteration: int
    trial: np.ndarray
    stimulus: np.ndarray
    object_distance_m: np.ndarray
    vergence_error_deg: np.ndarray
    metabolic_rate_w: np.ndarray
    optimal_metabolic_rate_w: np.ndarray
    rows: np.ndarray

    @property
    def n_iterations(self) -> int:
        """Iterations of a trial."""
        return self.vergence_error_deg.shape[1] - 1

    def delta_cost_w(self, iteration: int) -> np.ndarray:
        """Return C - C* (n_trials,) after an iteration."""
        cost_w: np.ndarray = self.metabolic_rate_w[:, iteration] - self.optimal_metabolic_rate_w
        return cost_w

    def cost_reduction(self, iteration: int) -> np.ndarray:
        """Return the share of the possible saving that was made (n_trials,).

        c = (C - C_0) / (C* - C_0)  (K17 eq. 8); nan where |C* - C_0| < LEAST_COST_RANGE_W.
        """
        start_w = self.metabolic_rate_w[:, 0]
        possible_w = self.optimal_metabolic_rate_w - start_w
        undefined = np.abs(possible_w) < LEAST_COST_RANGE_W
        made_w = self.metabolic_rate_w[:, iteration] - start_w
        return np.where(undefined, np.nan, made_w / np.where(undefined, 1.0, possible_w))

    def chosen(self, which: np.ndarray) -> "TestTrials":
        """Return the trials at the given indices or mask (n_trials,)."""
        names = [name for name, value in vars(self).items() if isinstance(value, np.ndarray)]
        return replace(self, **{name: getattr(self, name)[which] for name in names})


def split_tests(rows: np.ndarray) -> list[TestTrials]:
    """Return the tests among ground truth rows (n, len(GROUND_TRUTH_NAMES)), in their order.

    Rows must be in the order of their stamps; training rows are ignored. A trial that was broken
    off is left out; of one that was made twice the last counts.
    """
    rows = np.asarray(rows, dtype=np.float64)
    if rows.ndim != 2 or rows.shape[1] != len(GROUND_TRUTH_NAMES):
        raise InputError(
            f"expected ground truth rows of {len(GROUND_TRUTH_NAMES)} values, "
            f"got an array of shape {rows.shape}"
        )
    in_test = np.flatnonzero(rows[:, _COLUMN["phase"]] == TEST)
    numbers = rows[in_test, _COLUMN["test"]]
    found = [_trials(rows, in_test[numbers == number]) for number in np.unique(numbers)]
    return [trials for trials in found if trials is not None]


def _trials(rows: np.ndarray, chosen: np.ndarray) -> TestTrials | None:
    """Return the complete trials among the chosen rows of one test, None when there is none."""
    iteration = rows[chosen, _COLUMN["iteration"]].astype(int)
    n_rows = iteration.max() + 1
    starts = np.flatnonzero(iteration == 0)
    starts = starts[starts + n_rows <= len(chosen)]
    trials = starts[:, None] + np.arange(n_rows)
    complete = (iteration[trials] == np.arange(n_rows)).all(axis=1)
    trials = chosen[trials[complete]]
    by_trial = {int(rows[trial[0], _COLUMN["trial"]]): trial for trial in trials}
    if not by_trial:
        return None
    table = np.stack([by_trial[trial] for trial in sorted(by_trial)])

    def column(name: str) -> np.ndarray:
        values: np.ndarray = rows[table, _COLUMN[name]]
        return values

    return TestTrials(
        training_iteration=int(column("training_iteration")[0, 0]),
        trial=np.array(sorted(by_trial)),
        stimulus=column("stimulus")[:, 0].astype(int),
        object_distance_m=column("object_distance_m")[:, 0],
        vergence_error_deg=column("vergence_error_deg"),
        metabolic_rate_w=column("metabolic_rate_w"),
        optimal_metabolic_rate_w=column("optimal_metabolic_rate_w")[:, 0],
        rows=table,
    )


def test_summary(rows: np.ndarray) -> dict[str, Any]:
    """Return the measures of one test from its ground truth rows, as in results.json.

    Raises InputError unless the rows hold complete trials of exactly one test.
    """
    tests = split_tests(rows)
    if len(tests) != 1:
        raise InputError(f"expected the rows of one test, got those of {len(tests)}")
    return summary(tests[0])


test_summary.__test__ = False  # type: ignore[attr-defined]


def summary(trials: TestTrials) -> dict[str, Any]:
    """Return the measures of one test by the names of results.json.

    Medians and interquartile ranges are over trials; None where no trial counts. At the top level
    after the last iteration, below "after_1", "after_2", ... after those; below
    "without_zero_start_error" the same without trials that start with correct vergence, as the
    authors report it.
    """
    moved = np.abs(trials.vergence_error_deg[:, 0]) >= _ZERO_ERROR_DEG
    return {
        "iteration": trials.training_iteration,
        **_summary_of_all(trials),
        "without_zero_start_error": _summary_of_all(trials.chosen(moved)),
    }


def _summary_of_all(trials: TestTrials) -> dict[str, Any]:
    early = [k for k in REPORTED_ITERATIONS if k < trials.n_iterations]
    return {
        "n_trials": len(trials.trial),
        **measures(trials, trials.n_iterations),
        **{f"after_{k}": measures(trials, k) for k in early},
    }


def measures(trials: TestTrials, iteration: int) -> dict[str, float | None]:
    """Return the four measures after an iteration (quartiles by linear interpolation)."""
    error_deg = np.abs(trials.vergence_error_deg[:, iteration])
    return {
        "median_abs_vergence_error_deg": _quantile(error_deg, 0.5),
        "iqr_abs_vergence_error_deg": _spread(error_deg),
        "median_delta_cost_w": _quantile(trials.delta_cost_w(iteration), 0.5),
        "median_cost_reduction": _quantile(trials.cost_reduction(iteration), 0.5),
    }


def _quantile(values: np.ndarray, share: float) -> float | None:
    defined = values[~np.isnan(values)]
    return float(np.quantile(defined, share)) if len(defined) else None


def _spread(values: np.ndarray) -> float | None:
    if not len(values):
        return None
    lower, upper = np.quantile(values, (0.25, 0.75))
    return float(upper - lower)


def cost_share(
    reconstruction_error: Iterable[float],
    metabolic_rate_w: Iterable[float],
    metabolic_cost_weight: float,
) -> float | None:
    """Return the cost's share of the reward over some iterations, None when there are none.

    lambda C / (E + lambda C) with the means of E (both scales) and C; K17 eq. 5.
    """
    # Summed in order, as a running experiment does, so that both give the same bits.
    error = np.cumsum(np.fromiter(reconstruction_error, np.float64))
    cost_w = np.cumsum(np.fromiter(metabolic_rate_w, np.float64))
    if not len(error):
        return None
    priced = metabolic_cost_weight * float(cost_w[-1])
    return priced / (float(error[-1]) + priced)
