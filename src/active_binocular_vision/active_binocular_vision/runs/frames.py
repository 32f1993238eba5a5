"""Parts of a run as data frames of pandas: tests, their trials, basis functions."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import msgspec
import numpy as np

from experiment_manager import Summary, Trials
from experiment_manager.measures.trials import ERROR_NAMES
from eye_plant.vergence import degrees_per_px

if TYPE_CHECKING:
    import pandas

    from active_binocular_vision.learners.learners import FrozenLearners


def frame_of_tests(tests: Sequence[Summary]) -> "pandas.DataFrame":
    """Return a row per test, by its training iteration; measures of sets of trials are SET.NAME."""
    import pandas  # noqa: PLC0415 (takes half a second)

    frame = pandas.json_normalize([msgspec.to_builtins(test) for test in tests])
    return frame.set_index("iteration") if len(frame) else frame


def frame_of_trials(tests: Mapping[int, Trials]) -> "pandas.DataFrame":
    """Return a row per trial of each test: where it began, and where it ended.

    iteration: of training, before the test; start_...: before the first command. Errors are signed.
    Activations are NaN where a run keeps them of its last test alone.
    """
    import pandas  # noqa: PLC0415

    frames = [
        pandas.DataFrame(
            {
                "iteration": iteration,
                "trial": trials.trial,
                "stimulus": trials.stimulus,
                "object_distance_m": trials.object_distance_m,
                "start_error_deg": trials.vergence_error_deg[:, 0],
                **{name: trials.column(name)[:, -1] for name in _errors(trials)},
                "start_metabolic_rate_w": trials.metabolic_rate_w[:, 0],
                "metabolic_rate_w": trials.metabolic_rate_w[:, -1],
                "optimal_metabolic_rate_w": trials.optimal_metabolic_rate_w[:, -1],
                **{name: trials.column(name)[:, -1] for name in trials.space.names},
            }
        )
        for iteration, trials in tests.items()
    ]
    return pandas.concat(frames, ignore_index=True) if frames else pandas.DataFrame()


def _errors(trials: Trials) -> Sequence[str]:
    return ERROR_NAMES[:1] if trials.is_of_pair else ERROR_NAMES


def frame_of_basis_functions(learners: "FrozenLearners") -> "pandas.DataFrame":
    """Return a row per basis function: what it is tuned to, as `learners.basis_functions.Tuning`.

    basis_function: its number in its scale; disparity_deg: preferred, NaN where there is none.
    """
    import pandas  # noqa: PLC0415

    px_deg = degrees_per_px(learners.plant.camera.focal_length_px)
    frames = [
        pandas.DataFrame(
            {
                "scale": scale,
                "basis_function": np.arange(len(tuned.residual)),
                "is_gabor": tuned.is_gabor,
                "residual": tuned.residual,
                "orientation_deg": tuned.orientation_deg,
                "frequency_cycles_per_deg": 1.0 / (tuned.wavelength_px * px_deg),
                "binocularity": tuned.binocularity,
                "disparity_deg": tuned.disparity_px * px_deg,
            }
        )
        for scale, tuned in zip(learners.manager.scales.names, learners.tunings, strict=True)
    ]
    return pandas.concat(frames, ignore_index=True)
