"""The trials of a test: what started where, and what the eyes and muscles did."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from lockstep import COMMAND_SPACES, PAIR, CommandSpace, InputError
from lockstep.wire.topics import EPISODE_NAMES, GROUND_TRUTH_NAMES, TEST

# Of errors about the axes that commands may turn the eyes about; the pair's turn them about one.
ERROR_NAMES = ("vergence_error_deg", "vertical_error_deg", "cyclovergence_error_deg")
# Where the start costs what the optimum costs, the share saved (eq. 8) divides by nothing.
LEAST_COST_RANGE_W = 0.01


def trial_names(space: CommandSpace) -> tuple[str, ...]:
    """Return what is kept of each observation of a test: ground truth, and what commands set."""
    return (*GROUND_TRUTH_NAMES, *space.names)


@dataclass(frozen=True)
class TrialTable:
    """Observations with a column for each of `names`, in the order of their stamps.

    rows: (n, len(names)); space: of the commands that set the activations.
    """

    rows: np.ndarray
    space: CommandSpace

    def __post_init__(self) -> None:
        """Raise InputError for rows of another shape."""
        n = len(self.names)
        if self.rows.ndim != 2 or self.rows.shape[1] != n:
            raise InputError(
                f"expected rows of {n} numbers, got an array of shape {self.rows.shape}"
            )

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the columns."""
        return trial_names(self.space)

    @classmethod
    def of(cls, truth: np.ndarray, activations: np.ndarray, space: CommandSpace) -> "TrialTable":
        """Join ground truth (n, len(GROUND_TRUTH_NAMES)) and activations, of the same rows."""
        return cls(np.concatenate([truth, activations], axis=1), space)

    @classmethod
    def saved(cls, rows: np.ndarray, space: CommandSpace) -> "TrialTable":
        """Return the table of saved rows; if there are none, whatever columns they had."""
        return cls(rows, space) if len(rows) else cls.empty(space)

    @classmethod
    def empty(cls, space: CommandSpace) -> "TrialTable":
        """Return a table without rows."""
        return cls(np.zeros((0, len(trial_names(space)))), space)

    def column(self, name: str) -> np.ndarray:
        """Return one column (n,)."""
        return self.rows[:, self.names.index(name)]


@dataclass(frozen=True)
class Trials:
    """All trials of one test, by trial number.

    n_iterations is that of each trial; iteration 0 is the start, before the first command. trial:
    (n_trials,); columns: of trial_names(space), each (n_trials, n_iterations + 1), nan where
    nothing was recorded; rows: of the table that the trials came from, of the same shape.
    """

    space: CommandSpace
    training_iteration: int
    trial: np.ndarray
    columns: Mapping[str, np.ndarray]
    rows: np.ndarray

    @property
    def is_of_pair(self) -> bool:
        """Whether one command turned both eyes alike."""
        return self.space.turning == COMMAND_SPACES[PAIR]

    @property
    def n_iterations(self) -> int:
        """Iterations of a trial."""
        return self.rows.shape[1] - 1

    def column(self, name: str) -> np.ndarray:
        """Return one column (n_trials, n_iterations + 1), nan where it was not kept."""
        assert name in trial_names(self.space)
        return self.columns[name] if name in self.columns else np.full(self.rows.shape, np.nan)

    @property
    def vergence_error_deg(self) -> np.ndarray:
        """Signed vergence error (n_trials, n_iterations + 1)."""
        return self.column("vergence_error_deg")

    @property
    def metabolic_rate_w(self) -> np.ndarray:
        """C of the muscles that are commanded (n_trials, n_iterations + 1)."""
        return self.column("metabolic_rate_w")

    @property
    def activations(self) -> np.ndarray:
        """What commands set (n_trials, n_iterations + 1, n_commands)."""
        return np.stack([self.column(name) for name in self.space.names], axis=-1)

    @property
    def stimulus(self) -> np.ndarray:
        """Number of the stimulus (n_trials,)."""
        return self.column("stimulus")[:, 0].astype(int)

    @property
    def object_distance_m(self) -> np.ndarray:
        """Distance of the object (n_trials,)."""
        return self.column("object_distance_m")[:, 0]

    @property
    def optimal_metabolic_rate_w(self) -> np.ndarray:
        """C*, the least C of correct gaze at the time's target, (n_trials, n_iterations + 1)."""
        return self.column("optimal_metabolic_rate_w")

    def delta_cost_w(self, iteration: int) -> np.ndarray:
        """Return C - C* (n_trials,) after an iteration."""
        return self.metabolic_rate_w[:, iteration] - self.optimal_metabolic_rate_w[:, iteration]

    def cost_ratio(self, iteration: int) -> np.ndarray:
        """Return C / C* (n_trials,) after an iteration; nan where C* is 0."""
        least_w = self.optimal_metabolic_rate_w[:, iteration]
        return self.metabolic_rate_w[:, iteration] / np.where(least_w > 0.0, least_w, np.nan)

    def cost_reduction(self, iteration: int) -> np.ndarray:
        """Return the share of the possible saving that was made (n_trials,).

        c = (C - C_0) / (C* - C_0)  (K17 eq. 8); nan where C* and C_0 differ by less than
        LEAST_COST_RANGE_W.
        """
        start_w = self.metabolic_rate_w[:, 0]
        possible_w = self.optimal_metabolic_rate_w[:, iteration] - start_w
        undefined = np.abs(possible_w) < LEAST_COST_RANGE_W
        made_w = self.metabolic_rate_w[:, iteration] - start_w
        return np.where(undefined, np.nan, made_w / np.where(undefined, 1.0, possible_w))

    def chosen(self, which: np.ndarray) -> "Trials":
        """Return the trials at the given indices or mask (n_trials,)."""
        columns = {name: values[which] for name, values in self.columns.items()}
        return replace(self, trial=self.trial[which], columns=columns, rows=self.rows[which])


def split_tests(table: TrialTable, n_iterations: int) -> list[Trials]:
    """Return the tests among observations, in their order.

    n_iterations: of a whole trial, which has one row more. Training rows are ignored. A trial that
    was broken off is left out; of one that was made twice the last counts.
    """
    in_test = np.flatnonzero(table.column("phase") == TEST)
    numbers = table.column("test")[in_test]
    tests = [
        _trials(table, in_test[numbers == number], n_iterations + 1)
        for number in np.unique(numbers)
    ]
    return [trials for trials in tests if trials is not None]


def _trials(table: TrialTable, chosen: np.ndarray, n_rows: int) -> Trials | None:
    """Return the trials of n_rows among the chosen rows of one test, None when there is none."""
    iteration = table.column("iteration")[chosen].astype(int)
    starts = np.flatnonzero(iteration == 0)
    starts = starts[starts + n_rows <= len(chosen)]
    trials = starts[:, None] + np.arange(n_rows)
    complete = (iteration[trials] == np.arange(n_rows)).all(axis=1)
    by_trial = {int(table.column("trial")[rows[0]]): rows for rows in chosen[trials[complete]]}
    if not by_trial:
        return None
    rows = np.stack([by_trial[trial] for trial in sorted(by_trial)])
    return Trials(
        space=table.space,
        training_iteration=int(table.column("training_iteration")[rows[0, 0]]),
        trial=np.array(sorted(by_trial)),
        columns={
            name: table.column(name)[rows] for name in table.names if name not in EPISODE_NAMES
        },
        rows=rows,
    )


def only_test(table: TrialTable, n_iterations: int) -> Trials:
    """Return the trials of one test, of n_iterations each.

    Raises InputError unless the rows hold complete trials of exactly one test.
    """
    tests = split_tests(table, n_iterations)
    if len(tests) != 1:
        raise InputError(f"expected the rows of one test, got those of {len(tests)}")
    return tests[0]


def pooled(tests: Sequence[Trials]) -> Trials:
    """Return the trials of several runs' tests, of one command space, as if they were of one."""
    names = set.intersection(*(set(test.columns) for test in tests))
    return Trials(
        space=tests[0].space,
        training_iteration=tests[0].training_iteration,
        trial=np.concatenate([test.trial for test in tests]),
        columns={n: np.concatenate([test.columns[n] for test in tests]) for n in sorted(names)},
        rows=np.concatenate([test.rows for test in tests]),
    )
