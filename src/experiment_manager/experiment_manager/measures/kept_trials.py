"""trials.npz: the trials of a run's tests, small enough to keep, for figures and pooled tables.

Of every test the ends of its trials; of the last one more: what K17's Figs. 3 and 4 show.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from experiment_manager.measures.metrics import REPORTED_ITERATIONS
from experiment_manager.measures.trials import ERROR_NAMES, Trials
from lockstep import (
    COMMAND_SPACES,
    PAIR,
    CommandSpace,
    InputError,
    read_state,
    write_state,
)
from lockstep.command_space import ALL_MUSCLES, HORIZONTAL_RECTI, PAN_TILT_VERGENCE, VERGENCE

KEPT_FILE = "trials.npz"
_KIND = "trials_of_run"
_OTHER_ERROR_COLUMNS = ERROR_NAMES[1:]
# Of files that do not name their command space, by the number of commands.
_UNNAMED_SPACES = {
    len(COMMAND_SPACES[name].names): name
    for name in (PAIR, HORIZONTAL_RECTI, ALL_MUSCLES, VERGENCE, PAN_TILT_VERGENCE)
}


@dataclass(frozen=True)
class KeptTrials:
    """Trials of the tests that have the same trials as the last one; float32 where not whole.

    A trial begins and has its optimum in each test as in the last one, as long as the eyes stay as
    they are; of the tests in which they were others, this is kept apart.

    training_iteration: (n_tests,); final_error_deg, final_rate_w: (n_tests, n_trials), signed error
    and metabolic rate after the last iteration. Of the last test: trial, stimulus,
    object_distance_m: (n_trials,); iteration: (k,) those that are kept of each trial, 0 is the
    start; error_deg, rate_w, optimal_rate_w: (n_trials, k); activations: (n_trials, 2, n_commands)
    what commands set, at the start and at the end; path: (m,) indices of the pair's trials of the
    first stimulus, path_activations: (m, n_iterations + 1, n_commands). began_otherwise: (j,)
    indices of the tests that began otherwise than the last one; started_with: (j, 3, n_trials)
    their error and rate at the start, and optimal rate at the end. Vertical error and cyclovergence
    error, of none in the pair's tests: final_other_errors_deg, (n_tests, n_trials, 2),
    other_errors_deg, (n_trials, k, 2). command_space: () its name.
    """

    training_iteration: np.ndarray
    final_error_deg: np.ndarray
    final_rate_w: np.ndarray
    trial: np.ndarray
    stimulus: np.ndarray
    object_distance_m: np.ndarray
    optimal_rate_w: np.ndarray
    iteration: np.ndarray
    error_deg: np.ndarray
    rate_w: np.ndarray
    activations: np.ndarray
    path: np.ndarray
    path_activations: np.ndarray
    began_otherwise: np.ndarray
    started_with: np.ndarray
    final_other_errors_deg: np.ndarray
    other_errors_deg: np.ndarray
    command_space: np.ndarray

    @property
    def space(self) -> CommandSpace:
        """The space of the commands."""
        return COMMAND_SPACES[str(self.command_space)]

    def starts(self) -> np.ndarray:
        """Return first error, first rate and last optimal rate of tests, (n_tests, 3, n_trials)."""
        last = np.stack([self.error_deg[:, 0], self.rate_w[:, 0], self.optimal_rate_w[:, -1]])
        starts = np.repeat(last[None], len(self.training_iteration), axis=0)
        starts[self.began_otherwise] = self.started_with
        return starts

    def tests(self) -> list[Trials]:
        """Return the tests in order, with nan for what is not kept."""
        shape = (len(self.trial), int(self.iteration[-1]) + 1)
        starts = self.starts()
        space = self.space
        tests = []
        for i, training_iteration in enumerate(self.training_iteration):
            error_deg, rate_w = np.full((2, *shape), np.nan)
            activations = np.full((*shape, len(space.names)), np.nan)
            other_deg = np.full((*shape, len(_OTHER_ERROR_COLUMNS)), np.nan)
            if len(self.other_errors_deg):
                other_deg[:, -1] = self.final_other_errors_deg[i]
            error_deg[:, 0], rate_w[:, 0], last_w = starts[i]
            optimal_rate_w = np.repeat(last_w[:, None].astype(np.float64), shape[1], axis=1)
            error_deg[:, -1], rate_w[:, -1] = self.final_error_deg[i], self.final_rate_w[i]
            if i == len(self.training_iteration) - 1:
                error_deg[:, self.iteration] = self.error_deg
                rate_w[:, self.iteration] = self.rate_w
                optimal_rate_w[:, self.iteration] = self.optimal_rate_w
                if len(self.other_errors_deg):
                    other_deg[:, self.iteration] = self.other_errors_deg
                activations[:, [0, -1]] = self.activations
                activations[self.path] = self.path_activations
            of_trial = {"stimulus": self.stimulus, "object_distance_m": self.object_distance_m}
            columns = {n: np.broadcast_to(v[:, None], shape) for n, v in of_trial.items()}
            columns |= {"vergence_error_deg": error_deg, "metabolic_rate_w": rate_w}
            columns["optimal_metabolic_rate_w"] = optimal_rate_w
            columns |= {name: activations[..., k] for k, name in enumerate(space.names)}
            columns |= {n: other_deg[..., k] for k, n in enumerate(_OTHER_ERROR_COLUMNS)}
            no_rows = np.broadcast_to(-1, shape)
            tests.append(Trials(space, int(training_iteration), self.trial, columns, no_rows))
        return tests


def with_test(kept: KeptTrials | None, trials: Trials) -> KeptTrials:
    """Return what is kept after one more test; tests with other trials are forgotten."""
    n = trials.n_iterations
    iteration = np.array(sorted({0, n, *(k for k in REPORTED_ITERATIONS if k < n)}))
    final_error_deg = _small(trials.vergence_error_deg[None, :, n])
    final_rate_w = _small(trials.metabolic_rate_w[None, :, n])
    starts = _starts(trials)
    other_deg = _other_errors_deg(trials)
    final_other_deg = other_deg[None, :, n] if len(other_deg) else other_deg
    training_iteration = np.array([trials.training_iteration])
    if kept is not None and np.array_equal(kept.trial, trials.trial):
        training_iteration = np.append(kept.training_iteration, training_iteration)
        final_error_deg = np.concatenate([kept.final_error_deg, final_error_deg])
        final_rate_w = np.concatenate([kept.final_rate_w, final_rate_w])
        starts = np.concatenate([kept.starts(), starts])
        final_other_deg = np.concatenate([kept.final_other_errors_deg, final_other_deg])
    is_other = (starts != starts[-1]) & ~(np.isnan(starts) & np.isnan(starts[-1]))
    began_otherwise = np.flatnonzero(is_other.any(axis=(1, 2)))
    is_first = trials.stimulus == trials.stimulus.min()
    path = np.flatnonzero(is_first & trials.is_of_pair)
    return KeptTrials(
        training_iteration=training_iteration,
        final_error_deg=final_error_deg,
        final_rate_w=final_rate_w,
        trial=trials.trial,
        stimulus=trials.stimulus,
        object_distance_m=trials.object_distance_m,
        optimal_rate_w=_small(trials.optimal_metabolic_rate_w[:, iteration]),
        iteration=iteration,
        error_deg=_small(trials.vergence_error_deg[:, iteration]),
        rate_w=_small(trials.metabolic_rate_w[:, iteration]),
        activations=_small(trials.activations[:, [0, n]]),
        path=path,
        path_activations=_small(trials.activations[path]),
        began_otherwise=began_otherwise,
        started_with=starts[began_otherwise],
        final_other_errors_deg=final_other_deg,
        other_errors_deg=other_deg[:, iteration] if len(other_deg) else other_deg,
        command_space=np.array(
            next(name for name, space in COMMAND_SPACES.items() if space == trials.space)
        ),
    )


def _other_errors_deg(trials: Trials) -> np.ndarray:
    """Return vertical and cyclovergence errors, (n_trials, n_iterations + 1, 2); no pair's."""
    if trials.is_of_pair:
        return np.zeros((0, 0, len(_OTHER_ERROR_COLUMNS)), np.float32)
    return _small(np.stack([trials.column(name) for name in _OTHER_ERROR_COLUMNS], axis=-1))


def _starts(trials: Trials) -> np.ndarray:
    """Return first error, first rate and last optimal rate, (1, 3, n_trials)."""
    optimal_w = trials.optimal_metabolic_rate_w[:, -1]
    start = [trials.vergence_error_deg[:, 0], trials.metabolic_rate_w[:, 0], optimal_w]
    return _small(np.stack(start)[None])


def _small(values: np.ndarray) -> np.ndarray:
    return values.astype(np.float32)


def arrays_of(kept: KeptTrials | None) -> dict[str, np.ndarray]:
    """Return what is kept by name, nothing for None."""
    return {} if kept is None else dict(vars(kept))


def from_arrays(arrays: Mapping[str, np.ndarray]) -> KeptTrials | None:
    """Return what `arrays_of` was given; raises InputError for anything else."""
    if not arrays:
        return None
    names = set(KeptTrials.__dataclass_fields__)
    if set(arrays) == names - {"command_space"}:
        unnamed = _UNNAMED_SPACES.get(arrays["activations"].shape[-1], "")
        arrays = {**arrays, "command_space": np.array(unnamed)}
    if set(arrays) != names:
        raise InputError(f"expected {', '.join(sorted(names))}, got {', '.join(sorted(arrays))}")
    if arrays["optimal_rate_w"].ndim == 1:  # of a trial, as long as it did not depend on a target
        n_kept = len(arrays["iteration"])
        arrays = {**arrays, "optimal_rate_w": np.stack([arrays["optimal_rate_w"]] * n_kept, axis=1)}
    kept = KeptTrials(**arrays)
    if str(kept.command_space) not in COMMAND_SPACES:
        expected = ", ".join(COMMAND_SPACES)
        raise InputError(f"command_space: expected one of {expected}, got {kept.command_space}")
    n_tests, n_trials = len(kept.training_iteration), len(kept.trial)
    n_kept, n_commands = len(kept.iteration), len(kept.space.names)
    has_others = kept.space.turning != COMMAND_SPACES[PAIR]
    shapes = {
        "final_error_deg": (n_tests, n_trials),
        "final_rate_w": (n_tests, n_trials),
        "error_deg": (n_trials, n_kept),
        "rate_w": (n_trials, n_kept),
        "optimal_rate_w": (n_trials, n_kept),
        "activations": (n_trials, 2, n_commands),
        "started_with": (len(kept.began_otherwise), 3, n_trials),
        "final_other_errors_deg": (n_tests, n_trials, 2) if has_others else (0, 0, 2),
        "other_errors_deg": (n_trials, n_kept, 2) if has_others else (0, 0, 2),
    }
    for name, shape in shapes.items():
        if arrays[name].shape != shape:
            raise InputError(f"{name}: expected shape {shape}, got {arrays[name].shape}")
    return kept


def write_trials(directory: Path, kept: KeptTrials | None) -> None:
    """Write trials.npz of a run directory, if there is anything to keep.

    Raises OSError when the disk refuses; then an older file is untouched.
    """
    if kept is not None:
        write_state(directory / KEPT_FILE, _KIND, arrays_of(kept))


def read_kept(directory: Path) -> KeptTrials | None:
    """Return what a run directory's trials.npz has, None when there is no such file.

    Raises InputError when the file is damaged or another thing.
    """
    path = directory / KEPT_FILE
    if not path.is_file():
        return None
    try:
        return from_arrays(read_state(path, _KIND))
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
