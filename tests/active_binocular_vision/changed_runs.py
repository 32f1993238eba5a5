"""Runs as if they had come out otherwise."""

import copy
from dataclasses import replace

import numpy as np

from active_binocular_vision import Run
from experiment_manager import Trials


def with_errors(test: Trials, errors_deg: np.ndarray) -> Trials:
    return replace(test, columns={**test.columns, "vergence_error_deg": errors_deg})


def priced(run: Run, weight: float, error_factor: float) -> Run:
    """The same run as if it had another lambda and other errors, except at the start."""
    other = copy.copy(run)
    other.about = {**run.about, "metabolic_cost_weight": weight}
    factors = np.where(np.arange(21) > 0, error_factor, 1.0)
    other.tests = {
        at: with_errors(test, test.vergence_error_deg * factors) for at, test in run.tests.items()
    }
    return other
