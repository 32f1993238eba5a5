"""The measures of K17: vergence error and metabolic cost after 1, 2, 3 and 20 iterations of a test.

Medians and shares over trials; Delta C and c of each trial (K17 eq. 8) are in measures.trials.
"""

from typing import Any

import numpy as np

from experiment_manager.measures.criteria import Criteria
from experiment_manager.measures.trials import TestTrials, split_tests
from lockstep.errors import InputError

# K17 Fig. 3 shows these; the last one is what all tables report.
REPORTED_ITERATIONS = (1, 2, 3, 20)
# K17's share of the cost in the reward is told over so many iterations at either end of training.
SHARE_ITERATIONS = 5000
# A trial that ends farther off has not arrived.
ARRIVED_DEG = 1.0
# The authors' code has these start errors, and leaves 0 out of its measures.
AUTHORS_START_ERRORS_DEG = (-3.0, -2.0, -1.0, 1.0, 2.0)
# Trials start at whole degrees of error; the eyes settle within 0.02 deg.
_ZERO_ERROR_DEG = 0.1


def only_test(rows: np.ndarray, n_iterations: int) -> TestTrials:
    """Return the trials of one test, of n_iterations each, from its rows (n, len(TRIAL_NAMES)).

    Raises InputError unless the rows hold complete trials of exactly one test.
    """
    tests = split_tests(rows, n_iterations)
    if len(tests) != 1:
        raise InputError(f"expected the rows of one test, got those of {len(tests)}")
    return tests[0]


def test_summary(rows: np.ndarray, n_iterations: int, criteria: Criteria) -> dict[str, Any]:
    """Return the measures of one test from its rows, as in results.json; errors as only_test."""
    return summary(only_test(rows, n_iterations), criteria)


test_summary.__test__ = False  # type: ignore[attr-defined]


def summary(trials: TestTrials, criteria: Criteria) -> dict[str, Any]:
    """Return the measures of one test by the names of results.json.

    Over trials, None where no trial counts. At the top level after the last iteration, below
    "after_1", "after_2", ... after those. The same of fewer trials: below
    "without_zero_start_error" of those that do not start with correct vergence, below
    "authors_test_set" of those that start at AUTHORS_START_ERRORS_DEG.
    """
    start_deg = trials.vergence_error_deg[:, 0]
    return {
        "iteration": trials.training_iteration,
        **_summary_of_all(trials, criteria),
        "without_zero_start_error": _summary_of_all(
            trials.chosen(np.abs(start_deg) >= _ZERO_ERROR_DEG), criteria
        ),
        "authors_test_set": _summary_of_all(trials.chosen(in_authors_test_set(trials)), criteria),
    }


def in_authors_test_set(trials: TestTrials) -> np.ndarray:
    """Return which trials (n_trials,) the authors' code would have made, too."""
    start_deg = np.round(trials.vergence_error_deg[:, 0])
    return np.isin(start_deg, AUTHORS_START_ERRORS_DEG)


def _summary_of_all(trials: TestTrials, criteria: Criteria) -> dict[str, Any]:
    early = [k for k in REPORTED_ITERATIONS if k < trials.n_iterations]
    return {
        "n_trials": len(trials.trial),
        **measures(trials, trials.n_iterations, criteria),
        "bias_by_distance_deg": _bias_by_distance_deg(trials),
        **_of_each_eye(trials),
        **{f"after_{k}": measures(trials, k, criteria) for k in early},
    }


def measures(trials: TestTrials, iteration: int, criteria: Criteria) -> dict[str, float | None]:
    """Return the measures after an iteration (quartiles by linear interpolation)."""
    error_deg = np.abs(trials.vergence_error_deg[:, iteration])
    error_deg = error_deg[~np.isnan(error_deg)]
    return {
        "median_abs_vergence_error_deg": _quantile(error_deg, 0.5),
        "iqr_abs_vergence_error_deg": _spread(error_deg),
        "median_delta_cost_w": _quantile(trials.delta_cost_w(iteration), 0.5),
        "median_cost_reduction": _quantile(trials.cost_reduction(iteration), 0.5),
        "share_within_1_px": _share(error_deg < criteria.px_deg),
        "share_beyond_1_deg": _share(error_deg > ARRIVED_DEG),
        "share_right_muscle_silent": _share(_right_muscle_is_silent(trials, iteration, criteria)),
    }


def _bias_by_distance_deg(trials: TestTrials) -> dict[str, float | None]:
    """Return the median signed error after the last iteration by object distance in m.

    Above 0: the eyes end with too little vergence, as if the object stood farther away.
    """
    distance_m = trials.object_distance_m
    final_deg = trials.vergence_error_deg[:, -1]
    return {f"{d:g}": _quantile(final_deg[distance_m == d], 0.5) for d in np.unique(distance_m)}


def _of_each_eye(trials: TestTrials) -> dict[str, float | None]:
    """Return where the eyes look together, and how far each is turned in, after the last iteration.

    Other than vergence, these tell unlike eyes: a weak muscle, or the phoria of a covered eye.
    """
    left_deg, right_deg = trials.deviations_deg[:, -1].T
    return {
        "median_abs_version_deg": _quantile(np.abs(trials.version_deg[:, -1]), 0.5),
        "median_left_deviation_deg": _quantile(left_deg, 0.5),
        "median_right_deviation_deg": _quantile(right_deg, 0.5),
    }


def _right_muscle_is_silent(trials: TestTrials, iteration: int, criteria: Criteria) -> np.ndarray:
    """Return of the trials where one muscle should be silent whether it is (n,)."""
    activation = trials.activations[:, iteration]
    near = trials.object_distance_m <= criteria.lateral_is_silent_up_to_m
    far = trials.object_distance_m >= criteria.medial_is_silent_from_m
    antagonist = np.where(near, activation[:, 1], activation[:, 0])[near | far]
    return antagonist[~np.isnan(antagonist)] < criteria.silent_activation


def _share(true: np.ndarray) -> float | None:
    return float(true.mean()) if len(true) else None


def _quantile(values: np.ndarray, share: float) -> float | None:
    defined = values[~np.isnan(values)]
    return float(np.quantile(defined, share)) if len(defined) else None


def _spread(values: np.ndarray) -> float | None:
    if not len(values):
        return None
    lower, upper = np.quantile(values, (0.25, 0.75))
    return float(upper - lower)


def cost_share(
    reconstruction_error: float, metabolic_rate_w: float, metabolic_cost_weight: float
) -> float | None:
    """Return the cost's share of the reward, lambda C / (E + lambda C) (K17 eq. 5).

    reconstruction_error, metabolic_rate_w: E of both scales and C, summed over some iterations.
    None where the reward is nothing, as over no iterations.
    """
    priced = metabolic_cost_weight * metabolic_rate_w
    total = reconstruction_error + priced
    return priced / total if total else None
