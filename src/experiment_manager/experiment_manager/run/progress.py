"""What an experiment counts up while it runs: errors, rewards, tests. No ROS, no clock."""

import math
from collections import deque
from copy import copy

import msgspec
import numpy as np

from experiment_manager.measures.criteria import Criteria
from experiment_manager.measures.kept_trials import KeptTrials, with_test
from experiment_manager.measures.metrics import SHARE_ITERATIONS, cost_share, summary_of
from experiment_manager.measures.results import Summary
from experiment_manager.measures.trials import TrialTable, only_test
from lockstep import CommandSpace, InputError
from lockstep.wire.topics import GROUND_TRUTH_NAMES, TEST, TRAINING, reward_names

_N_RUNNING = 200

_TRUTH = {name: i for i, name in enumerate(GROUND_TRUTH_NAMES)}
# From the end: the errors of all scales come before.
_OF_SCALES = slice(reward_names(()).index("metabolic_rate_w") - len(reward_names(())))
_RATE = _OF_SCALES.stop


class Sums(msgspec.Struct):
    """Sums of E and C over n training iterations, counted from one of them on."""

    error: float = 0.0
    cost_w: float = 0.0
    n: int = 0
    counted_from: int = 0


class ProgressState(msgspec.Struct, frozen=True):
    """What a checkpoint's manifest has of the progress: all but the trials.

    first, last: of the first and the last iterations of training; left: activations (n_muscles,) of
    the commanded muscles at the end of the last training episode, none before it.
    """

    tests: list[Summary]
    first: Sums
    last: Sums
    running_errors_deg: list[float]
    left: list[float] = []


class Progress:
    """Collects ground truth, activations and rewards, and sums them up.

    `state`, `trial_table`, `kept_trials` and `restore` carry it through a checkpoint, also
    during a test.
    """

    def __init__(self, n_training_iterations: int, space: CommandSpace) -> None:
        """n_training_iterations: of the whole run; space: of its commands."""
        self._n_training_iterations = n_training_iterations
        self.space = space
        self.tests: list[Summary] = []
        self.kept_trials: KeptTrials | None = None
        # Of float64. A test has ten thousands of rows: as lists of numbers they would be 20 MB.
        self._truth_bytes = bytearray()
        self._activation_bytes = bytearray()
        # Of the first and the last iterations of training.
        self._sums = {"first": Sums(), "last": Sums()}
        self._running_errors_deg: deque[float] = deque(maxlen=_N_RUNNING)
        self.left: list[float] = []

    def add_truth(self, values: np.ndarray, is_last: bool) -> None:
        """Add one observation's ground truth; is_last: it ends an episode."""
        if values[_TRUTH["phase"]] == TEST:
            self._truth_bytes += values.astype(np.float64).tobytes()
        elif is_last:
            error_deg = abs(float(values[_TRUTH["vergence_error_deg"]]))
            if not math.isnan(error_deg):
                self._running_errors_deg.append(error_deg)

    def add_activations(self, phase: int, activations: np.ndarray) -> None:
        """Add one observation's activations, (n_muscles,) of the muscles that are commanded.

        Of an observation, they may come before or after its ground truth. In training the last one
        of an episode is enough.
        """
        if phase == TRAINING:
            self.left = activations.tolist()
        else:
            means = self.space.from_muscles(activations.astype(np.float64))
            self._activation_bytes += means.tobytes()

    def add_reward(self, phase: int, training_iteration: int, values: np.ndarray) -> None:
        """Add one observation's reward: the values of lockstep.wire.topics.reward_names."""
        if phase != TRAINING:
            return
        error = float(np.sum(values[_OF_SCALES]))
        # Joints have none, and lambda is 0.
        cost_w = float(np.nan_to_num(values[_RATE]))
        if training_iteration < SHARE_ITERATIONS:
            self._count("first", error, cost_w)
        if training_iteration >= self._n_training_iterations - SHARE_ITERATIONS:
            self._count("last", error, cost_w)

    def begin_at(self, training_iteration: int) -> None:
        """Begin to count here: the run has been somebody else's before."""
        self._sums = {end: Sums(counted_from=training_iteration) for end in self._sums}

    def extend(self, n_training_iterations: int, trained: int) -> None:
        """Go on to another end of training, `trained` iterations being done.

        Raises InputError when some of the new last iterations are already over and not counted.
        """
        before, after = (
            max(0, n - SHARE_ITERATIONS)
            for n in (self._n_training_iterations, n_training_iterations)
        )
        if before < trained and before != after:
            if trained > after:
                raise InputError(
                    f"n_training_iterations: expected {trained + SHARE_ITERATIONS} or more, "
                    f"since energy's share is measured over the last {SHARE_ITERATIONS}, "
                    f"got {n_training_iterations}"
                )
            self._sums["last"] = Sums(counted_from=self._sums["last"].counted_from)
        self._n_training_iterations = n_training_iterations

    def _count(self, end: str, error: float, cost_w: float) -> None:
        sums = self._sums[end]
        sums.error += error
        sums.cost_w += cost_w
        sums.n += 1

    def end_test(self, n_iterations: int, criteria: Criteria) -> Summary:
        """Return the summary of the test whose last trial, of n_iterations, has been added."""
        trials = only_test(self.trial_table(), n_iterations)
        self.tests.append(summary_of(trials, criteria))
        self.kept_trials = with_test(self.kept_trials, trials)
        self._keep(TrialTable.empty(self.space))
        return self.tests[-1]

    def cost_share(self, end: str, metabolic_cost_weight: float) -> float | None:
        """Return lambda C / (E + lambda C) over the "first" or "last" training iterations.

        None where they were not all counted.
        """
        begin = 0 if end == "first" else max(0, self._n_training_iterations - SHARE_ITERATIONS)
        sums = self._sums[end]
        if sums.counted_from > begin:
            return None
        return cost_share(sums.error, sums.cost_w, metabolic_cost_weight)

    @property
    def running_median_error_deg(self) -> float | None:
        """Median of |vergence error| at the ends of the latest training episodes."""
        errors_deg = self._running_errors_deg
        return float(np.median(errors_deg)) if errors_deg else None

    def state(self) -> ProgressState:
        """Return all but the trials."""
        first, last = (copy(sums) for sums in self._sums.values())
        return ProgressState(
            list(self.tests), first, last, list(self._running_errors_deg), self.left
        )

    def trial_table(self) -> TrialTable:
        """Return the observations of the test under way.

        Raises InputError when ground truth or activations of some have not come.
        """
        truth = np.frombuffer(bytes(self._truth_bytes)).reshape(-1, len(GROUND_TRUTH_NAMES))
        n_activations = len(self.space.names)
        activations = np.frombuffer(bytes(self._activation_bytes)).reshape(-1, n_activations)
        if len(truth) != len(activations):
            raise InputError(
                f"expected activations of {len(truth)} observations of a test, got those of "
                f"{len(activations)}"
            )
        return TrialTable.of(truth, activations, self.space)

    def _keep(self, table: TrialTable) -> None:
        rows = table.rows.astype(np.float64)
        n_truth = len(GROUND_TRUTH_NAMES)
        self._truth_bytes = bytearray(rows[:, :n_truth].tobytes())
        self._activation_bytes = bytearray(rows[:, n_truth:].tobytes())

    def restore(
        self, state: ProgressState, trials: TrialTable, kept_trials: KeptTrials | None = None
    ) -> None:
        """Restore the progress that a checkpoint has."""
        self.tests = list(state.tests)
        self._sums = {"first": copy(state.first), "last": copy(state.last)}
        self._running_errors_deg = deque(state.running_errors_deg, maxlen=_N_RUNNING)
        self.left = state.left
        self.kept_trials = kept_trials
        self._keep(trials)
