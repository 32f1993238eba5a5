"""rearing.json: what the page of conditions has measured in each run, for programs to read."""

import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from experiment_manager.analysis.basis_functions import Tuning
from experiment_manager.analysis.rearing.reared_run import RearedRun
from experiment_manager.analysis.report.dictionary_figures import SCALES
from lockstep.durable_files import replace_file

MEASURES_FILE = "rearing.json"


def write_measures(path: Path, runs: Sequence[RearedRun]) -> None:
    """Write the measures of runs, a line for each; raises OSError when the disk refuses."""
    lines = ",\n".join(json.dumps(run_measures(run), allow_nan=False) for run in runs)
    replace_file(path, f'{{"runs": [\n{lines}\n]}}\n'.encode())


def run_measures(run: RearedRun) -> dict[str, Any]:
    """Return what the run's newest checkpoint was measured to be; None stands for undefined.

    Its tests are in its results.json.
    """
    landscape = run.landscape
    return {
        "run": run.directory.name,
        "condition": run.condition,
        "model": run.results.model,
        "seed": run.results.seed,
        "iterations": run.results.iterations,
        "landscape": {
            "vergence_error_deg": _rounded(landscape.vergence_error_deg),
            "reconstruction_error_coarse": _rounded(landscape.reconstruction_error[:, 0]),
            "reconstruction_error_fine": _rounded(landscape.reconstruction_error[:, 1]),
            "depth": _number(landscape.depth),
        },
        "left_share": _number(landscape.left_share),
        **{
            scale: _scale_measures(tuning, use, run.focal_length_px)
            for scale, tuning, use in zip(SCALES, run.tunings, landscape.use, strict=True)
        },
    }


def _scale_measures(
    tuning: Tuning, use: NDArray[np.float64], focal_length_px: float
) -> dict[str, Any]:
    return {
        "gabor_share": tuning.gabor_share,
        "gabor_share_by_use": _number(float(use[tuning.is_gabor].sum())),
        "common_gabor_share": tuning.common_gabor_share,
        "binocular_share": _number(tuning.binocular_share),
        "orientation_counts": tuning.orientation_counts().tolist(),
        "binocularity_counts": tuning.binocularity_counts().tolist(),
        "preferred_disparities_deg": _rounded(np.sort(tuning.disparities_deg(focal_length_px))),
    }


def _rounded(values: NDArray[np.float64]) -> list[float | None]:
    return [_number(value) for value in values.tolist()]


def _number(value: float) -> float | None:
    return round(value, 6) if math.isfinite(value) else None
