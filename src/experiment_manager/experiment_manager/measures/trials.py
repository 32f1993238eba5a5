"""The trials of a test: what started where, and what the eyes and muscles did."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from lockstep.command_space import COMMAND_SPACES, PAIR
from lockstep.errors import InputError
from lockstep.wire.topics import GROUND_TRUTH_NAMES, TEST

# What is kept of each observation of a test: ground truth, and the activations that commands set.
TRIAL_NAMES = (*GROUND_TRUTH_NAMES, *COMMAND_SPACES[PAIR].names)
# Where the start costs what the optimum costs, the share saved (eq. 8) divides by nothing.
LEAST_COST_RANGE_W = 0.01

_COLUMN = {name: i for i, name in enumerate(TRIAL_NAMES)}


@dataclass(frozen=True)
class TestTrials:
    """All trials of one test, by trial number.

    n_iterations is that of each trial; iteration 0 is the start, before the first command.
    vergence_error_deg, version_deg, metabolic_rate_w: (n_trials, n_iterations + 1); deviations_deg:
    of the left and the right eye, (n_trials, n_iterations + 1, 2); optimal_metabolic_rate_w,
    object_distance_m, stimulus, trial: (n_trials,); activations: medial and lateral rectus, mean
    of both eyes, nan where they were not recorded, (n_trials, n_iterations + 1, 2); rows: the
    rows of the table that the trials came from, (n_trials, n_iterations + 1).
    """

    __test__ = False  # the name is K17's; pytest need not collect it

    training_iteration: int
    trial: np.ndarray
    stimulus: np.ndarray
    object_distance_m: np.ndarray
    vergence_error_deg: np.ndarray
    version_deg: np.ndarray
    deviations_deg: np.ndarray
    metabolic_rate_w: np.ndarray
    optimal_metabolic_rate_w: np.ndarray
    activations: np.ndarray
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


def split_tests(rows: np.ndarray, n_iterations: int) -> list[TestTrials]:
    """Return the tests among rows (n, len(TRIAL_NAMES)), in their order.

    n_iterations: of a whole trial, which has one row more. Rows must be in the order of their
    stamps; training rows are ignored. A trial that was broken off is left out; of one that was made
    twice the last counts.
    """
    rows = np.asarray(rows, dtype=np.float64)
    if rows.ndim != 2 or rows.shape[1] != len(TRIAL_NAMES):
        raise InputError(
            f"expected rows of {len(TRIAL_NAMES)} values, got an array of shape {rows.shape}"
        )
    in_test = np.flatnonzero(rows[:, _COLUMN["phase"]] == TEST)
    numbers = rows[in_test, _COLUMN["test"]]
    found = [
        _trials(rows, in_test[numbers == number], n_iterations + 1) for number in np.unique(numbers)
    ]
    return [trials for trials in found if trials is not None]


def _trials(rows: np.ndarray, chosen: np.ndarray, n_rows: int) -> TestTrials | None:
    """Return the trials of n_rows among the chosen rows of one test, None when there is none."""
    iteration = rows[chosen, _COLUMN["iteration"]].astype(int)
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
        version_deg=column("version_deg"),
        deviations_deg=np.stack(
            [column("left_deviation_deg"), column("right_deviation_deg")], axis=-1
        ),
        metabolic_rate_w=column("metabolic_rate_w"),
        optimal_metabolic_rate_w=column("optimal_metabolic_rate_w")[:, 0],
        activations=np.stack([column("medial_rectus"), column("lateral_rectus")], axis=-1),
        rows=table,
    )


def pooled(tests: Sequence[TestTrials]) -> TestTrials:
    """Return the trials of several runs' tests as if they were of one."""
    names = [name for name, value in vars(tests[0]).items() if isinstance(value, np.ndarray)]
    joined = {name: np.concatenate([getattr(test, name) for test in tests]) for name in names}
    return TestTrials(training_iteration=tests[0].training_iteration, **joined)
