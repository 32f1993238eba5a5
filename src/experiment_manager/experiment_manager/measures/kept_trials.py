"""trials.npz: the trials of a run's tests, small enough to keep, for figures and pooled tables.

Of every test the ends of its trials; of the last one more: what K17's Figs. 3 and 4 show.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from experiment_manager.measures.metrics import REPORTED_ITERATIONS
from experiment_manager.measures.trials import TestTrials
from lockstep.errors import InputError
from lockstep.state_file import read_state, write_state

KEPT_FILE = "trials.npz"
_KIND = "trials_of_run"


@dataclass(frozen=True)
class KeptTrials:
    """Trials of the tests that have the same trials as the last one; float32 where not whole.

    training_iteration: (n_tests,); final_error_deg, final_rate_w: (n_tests, n_trials), signed error
    and metabolic rate after the last iteration. Of the last test: trial, stimulus,
    object_distance_m, optimal_rate_w: (n_trials,); iteration: (k,) those that are kept of each
    trial, 0 is the start; error_deg, rate_w: (n_trials, k); activations: (n_trials, k, 2) of medial
    and lateral rectus, mean of both eyes; path: (m,) indices of the trials of the first stimulus;
    path_activations: (m, n_iterations + 1, 2).
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

    def tests(self) -> list[TestTrials]:
        """Return the tests in order, with nan for what is not kept.

        Of all but the last one, the starts are those of the last: each test begins alike.
        """
        n_trials, n = len(self.trial), int(self.iteration[-1])
        found = []
        for i, training_iteration in enumerate(self.training_iteration):
            error_deg, rate_w = (np.full((n_trials, n + 1), np.nan) for _ in range(2))
            activations = np.full((n_trials, n + 1, 2), np.nan)
            is_last = i == len(self.training_iteration) - 1
            kept = slice(None) if is_last else slice(0, 1)
            error_deg[:, self.iteration[kept]] = self.error_deg[:, kept]
            rate_w[:, self.iteration[kept]] = self.rate_w[:, kept]
            error_deg[:, n], rate_w[:, n] = self.final_error_deg[i], self.final_rate_w[i]
            if is_last:
                activations[:, self.iteration] = self.activations
                activations[self.path] = self.path_activations
            found.append(
                TestTrials(
                    training_iteration=int(training_iteration),
                    trial=self.trial,
                    stimulus=self.stimulus,
                    object_distance_m=self.object_distance_m,
                    vergence_error_deg=error_deg,
                    version_deg=np.full((n_trials, n + 1), np.nan),
                    deviations_deg=np.full((n_trials, n + 1, 2), np.nan),
                    metabolic_rate_w=rate_w,
                    optimal_metabolic_rate_w=self.optimal_rate_w.astype(np.float64),
                    activations=activations,
                    rows=np.zeros((n_trials, n + 1), dtype=int),
                )
            )
        return found


def with_test(kept: KeptTrials | None, trials: TestTrials) -> KeptTrials:
    """Return what is kept after one more test; tests with other trials are forgotten."""
    n = trials.n_iterations
    iteration = np.array(sorted({0, n, *(k for k in REPORTED_ITERATIONS if k < n)}))
    final_error_deg = _small(trials.vergence_error_deg[None, :, n])
    final_rate_w = _small(trials.metabolic_rate_w[None, :, n])
    training_iteration = np.array([trials.training_iteration])
    if kept is not None and np.array_equal(kept.trial, trials.trial):
        training_iteration = np.append(kept.training_iteration, training_iteration)
        final_error_deg = np.concatenate([kept.final_error_deg, final_error_deg])
        final_rate_w = np.concatenate([kept.final_rate_w, final_rate_w])
    path = np.flatnonzero(trials.stimulus == trials.stimulus.min())
    return KeptTrials(
        training_iteration=training_iteration,
        final_error_deg=final_error_deg,
        final_rate_w=final_rate_w,
        trial=trials.trial,
        stimulus=trials.stimulus,
        object_distance_m=trials.object_distance_m,
        optimal_rate_w=_small(trials.optimal_metabolic_rate_w),
        iteration=iteration,
        error_deg=_small(trials.vergence_error_deg[:, iteration]),
        rate_w=_small(trials.metabolic_rate_w[:, iteration]),
        activations=_small(trials.activations[:, iteration]),
        path=path,
        path_activations=_small(trials.activations[path]),
    )


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
    if set(arrays) != names:
        raise InputError(f"expected {', '.join(sorted(names))}, got {', '.join(sorted(arrays))}")
    kept = KeptTrials(**arrays)
    n_trials, n_kept = len(kept.trial), len(kept.iteration)
    shapes = {
        "final_error_deg": (len(kept.training_iteration), n_trials),
        "final_rate_w": (len(kept.training_iteration), n_trials),
        "error_deg": (n_trials, n_kept),
        "rate_w": (n_trials, n_kept),
        "activations": (n_trials, n_kept, 2),
    }
    for name, shape in shapes.items():
        if arrays[name].shape != shape:
            raise InputError(f"{name}: expected shape {shape}, got {arrays[name].shape}")
    return kept


def write_trials(directory: Path, kept: KeptTrials | None) -> None:
    """Write trials.npz of a run directory, if there is anything to keep.

    Raises OSError when the disk refuses; then an older file is untouched.
    """
    if kept is None:
        return
    try:
        write_state(directory / KEPT_FILE, _KIND, arrays_of(kept))
    except InputError as error:
        raise OSError(str(error)) from error


def read_trials(directory: Path) -> list[TestTrials]:
    """Return the tests in a run directory's trials.npz, none when there is no such file.

    Raises InputError when the file is damaged or another thing.
    """
    path = directory / KEPT_FILE
    if not path.is_file():
        return []
    try:
        kept = from_arrays(read_state(path, _KIND))
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    return kept.tests() if kept else []
