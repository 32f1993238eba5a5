"""What a run's bag holds, reduced to what tables and figures need."""

from dataclasses import dataclass

import numpy as np

from experiment_manager import Bag, EvaluationSettings, VectorTable
from experiment_manager.bag.metadata import CONFIGURATION_ATTACHMENT
from experiment_manager.measures.metrics import QUARTILES, SHARE_ITERATIONS, cost_share
from experiment_manager.measures.trials import Trials, TrialTable, split_tests
from experiment_manager.run.config_file import parameters_in
from lockstep import CommandSpace, InputError
from lockstep.wire.topics import (
    GROUND_TRUTH_NAMES,
    PICTURES,
    RIGHT_TARGET_NAMES,
    TRAINING,
    state_topic,
)

# The error of a single episode says how hard it was; a median over some says what was learned.
_MOST_CURVE_BINS = 100
_EPISODES_PER_BIN = 25


@dataclass(frozen=True)
class PicturedEpisodes:
    """truth: all of the bag's ground truth; rows: those of each episode with pictures, by time."""

    truth: VectorTable
    rows: tuple[np.ndarray, ...]


@dataclass(frozen=True)
class RecordedTest:
    """One test: its trials, and what the sparse coder made of them.

    reconstruction_error: (n_trials, n_iterations + 1) both scales, nan after the last iteration;
    stamps_ns: (n_trials, n_iterations + 1).
    """

    trials: Trials
    reconstruction_error: np.ndarray
    stamps_ns: np.ndarray


@dataclass(frozen=True)
class TrainingCurve:
    """The ends of training episodes, in bins of equal numbers of episodes.

    iteration: (n_bins,) of training; quartiles_deg: of |vergence error|, (3, n_bins) lower, median,
    upper; quartiles_w: of the metabolic rate above the least one, Delta C, the same.
    """

    iteration: np.ndarray
    quartiles_deg: np.ndarray
    quartiles_w: np.ndarray


@dataclass(frozen=True)
class Measured:
    """What a bag holds of a run.

    tests: that begin in the bag, in their order; of the last one, its whole trials. cost_shares:
    lambda's share of the reward over the first and last 5,000 training iterations, None where they
    are not all in the bag. first_observation: its number; not 0 where the run was resumed from a
    checkpoint alone, without the bag of what was before.
    """

    tests: tuple[RecordedTest, ...]
    training_curve: TrainingCurve
    cost_shares: tuple[float | None, float | None]
    first_observation: int


def measured(bag: Bag, settings: EvaluationSettings, n_iterations: int, weight: float) -> Measured:
    """Return what a run's bag holds, in one pass.

    settings: how the run was tested; n_iterations: of training; weight: lambda, 1/W.
    """
    # The tables of a full run fill half a gigabyte; only what is made of them is kept.
    states = state_topic(settings.plant.space)
    tables = bag.vectors("ground_truth", "reward", states)
    truth, reward = tables["ground_truth"], tables["reward"]
    table = trial_table(truth, tables[states], settings.plant.space)
    tests = split_tests(table, settings.iterations_per_trial)
    return Measured(
        tuple(_recorded(trials, truth, reward) for trials in tests if trials.trial[0] == 0),
        _training_curve(truth),
        _shares(truth, reward, n_iterations, weight),
        int(truth.column("observation")[0]) if len(truth.stamps_ns) else 0,
    )


def _shares(
    truth: VectorTable, reward: VectorTable, n_iterations: int, weight: float
) -> tuple[float | None, float | None]:
    rows = truth.at(reward.stamps_ns)
    training = (rows >= 0) & (truth.column("phase")[rows] == TRAINING)
    iteration = truth.column("training_iteration")[rows]
    # Joints have no rate, and cost nothing.
    error, cost_w = _total_error(reward), np.nan_to_num(reward.column("metabolic_rate_w"))
    begin = iteration[training].min(initial=n_iterations)
    reached = iteration[training].max(initial=-1) + 1

    def share(first: int, end: int) -> float | None:
        if begin > first or reached < end:
            return None
        chosen = training & (iteration >= first) & (iteration < end)
        return cost_share(_sum_in_order(error[chosen]), _sum_in_order(cost_w[chosen]), weight)

    n = n_iterations
    return share(0, min(SHARE_ITERATIONS, n)), share(max(0, n - SHARE_ITERATIONS), n)


def pictured_episodes(bag: Bag) -> PicturedEpisodes:
    """Return the episodes with a pair of pictures; InputError when there is none."""
    truth = bag.vectors("ground_truth")["ground_truth"]
    number = np.cumsum(truth.column("iteration") == 0)
    left, right = (set(bag.stamps_ns(t).tolist() if bag.has(t) else ()) for t in PICTURES)
    both = np.array(sorted(left & right), np.int64)
    wanted = np.unique(number[np.isin(truth.stamps_ns, both)])
    if not len(wanted):
        raise InputError(f"bag {bag.path}: expected images of both eyes, it has none")
    return PicturedEpisodes(truth, tuple(np.flatnonzero(number == n) for n in wanted))


def evaluation_settings_of(bag: Bag) -> EvaluationSettings:
    """Return how the run of a bag was tested; InputError for a bag without its configuration."""
    text = bag.attachment(CONFIGURATION_ATTACHMENT).decode()
    return EvaluationSettings.of(parameters_in(text))


def _sum_in_order(values: np.ndarray) -> float:
    """Return the sum of (n,) values with the bits that a running experiment gets."""
    return float(np.cumsum(values)[-1]) if len(values) else 0.0


def _total_error(reward: VectorTable) -> np.ndarray:
    of_scales = [name for name in reward.names if name.startswith("reconstruction_error_")]
    return np.sum([reward.column(name) for name in of_scales], axis=0)


def trial_table(
    truth: VectorTable, activations: VectorTable | None, space: CommandSpace
) -> TrialTable:
    """Return ground truth and the activations at its stamps, nan for gaps.

    Of an older bag some of the truth is nan, too: where the right eye saw gaze targets.
    """
    of_commands = np.full((len(truth.stamps_ns), len(space.names)), np.nan)
    if activations is not None and len(activations.stamps_ns):
        of_commands = _at_stamps(activations, commanded(activations, space), truth.stamps_ns)
    unknown = np.full(len(truth.stamps_ns), np.nan)
    columns = [
        unknown if name in RIGHT_TARGET_NAMES and name not in truth.names else truth.column(name)
        for name in GROUND_TRUTH_NAMES
    ]
    return TrialTable.of(np.stack(columns, axis=1), of_commands, space)


def commanded(activations: VectorTable, space: CommandSpace) -> np.ndarray:
    """Return what commands set, (n, n_commands), from the activations of the muscles."""
    values = np.stack([activations.column(name) for name in space.muscle_names], axis=1)
    return space.from_muscles(values)


def _recorded(trials: Trials, truth: VectorTable, reward: VectorTable) -> RecordedTest:
    stamps_ns = truth.stamps_ns[trials.rows]
    return RecordedTest(
        trials=trials,
        reconstruction_error=_at_stamps(reward, _total_error(reward), stamps_ns),
        stamps_ns=stamps_ns,
    )


def _at_stamps(table: VectorTable, values: np.ndarray, stamps_ns: np.ndarray) -> np.ndarray:
    """Return the values (n, ...) of a table's rows at stamps of any shape; nan where none is."""
    rows = table.at(stamps_ns.ravel())
    if not len(values):
        return np.full((*stamps_ns.shape, *values.shape[1:]), np.nan)
    is_there = rows.reshape(-1, *[1] * (values.ndim - 1)) >= 0
    return np.where(is_there, values[rows], np.nan).reshape(*stamps_ns.shape, *values.shape[1:])


def _training_curve(truth: VectorTable) -> TrainingCurve:
    training = truth.column("phase") == TRAINING
    iteration = truth.column("iteration")
    # An episode's last observation: the next row, if any, is not its continuation.
    follows = np.append(iteration[1:] == iteration[:-1] + 1, [False])
    ends = np.flatnonzero(training & ~follows)
    n_bins = min(_MOST_CURVE_BINS, -(-len(ends) // _EPISODES_PER_BIN))
    bins = np.array_split(ends, n_bins) if n_bins else []
    error_deg = np.abs(truth.column("vergence_error_deg"))
    delta_w = truth.column("metabolic_rate_w") - truth.column("optimal_metabolic_rate_w")
    at = truth.column("training_iteration")

    def quartiles(values: np.ndarray) -> np.ndarray:
        of_bins = [np.quantile(values[part], QUARTILES) for part in bins]
        return np.array(of_bins).reshape(len(bins), 3).T

    return TrainingCurve(
        np.array([float(at[part].mean()) for part in bins]),
        quartiles(error_deg),
        quartiles(delta_w),
    )
