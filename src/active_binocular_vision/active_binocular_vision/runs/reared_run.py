"""What a run has become, and rearing.json, which keeps what was measured in its checkpoint."""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from active_binocular_vision.examinations.landscape import RewardLandscape
from active_binocular_vision.figures.dictionaries import SCALES
from experiment_manager.measures.results import Results
from lockstep import InputError
from lockstep.durable_files import replace_file

MEASURES_FILE = "rearing.json"


@dataclass(frozen=True)
class ScaleTuning:
    """What the basis functions of one scale are tuned to.

    Shares of all its basis functions; by use, of their squared coefficients in the code of the
    landscape's pictures; binocular_share, of the Gabor functions, nan where there are none. Counts:
    of the Gabor functions, (8,) from horizontal on, and (7,) from left to right.
    preferred_disparities_deg: of those that have one, in order.
    """

    gabor_share: float
    gabor_share_by_use: float
    common_gabor_share: float
    binocular_share: float
    orientation_counts: NDArray[np.int64]
    binocularity_counts: NDArray[np.int64]
    preferred_disparities_deg: NDArray[np.float64]


@dataclass(frozen=True)
class RearedRun:
    """One run of a condition.

    condition: its profile without the folder, or the directory's name; scales: coarse, fine;
    samples: basis functions from the best to the worst Gabor fit, (2, n, 128), None without a
    checkpoint; focal_length_px: of the cameras; changed_at: training iterations at which its
    schedule changes the plant.
    """

    directory: Path
    condition: str
    results: Results
    landscape: RewardLandscape
    scales: tuple[ScaleTuning, ...]
    samples: NDArray[np.float32] | None
    focal_length_px: float
    changed_at: tuple[int, ...]


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
            "vergence_error_deg": _plain(landscape.vergence_error_deg),
            "reconstruction_error_coarse": _plain(landscape.reconstruction_error[:, 0]),
            "reconstruction_error_fine": _plain(landscape.reconstruction_error[:, 1]),
            "depth": _plain(landscape.depth),
        },
        "left_share": _plain(landscape.left_share),
        **{
            scale: {name: _plain(value) for name, value in vars(tuning).items()}
            for scale, tuning in zip(SCALES, run.scales, strict=True)
        },
    }


def read_measures(path: Path, run: str) -> tuple[RewardLandscape, tuple[ScaleTuning, ...]] | None:
    """Return what a file says of a run; None without the file or the run in it.

    Raises InputError for a file that is damaged.
    """
    if not path.is_file():
        return None
    try:
        runs = {of_run["run"]: of_run for of_run in json.loads(path.read_text())["runs"]}
        return _parsed(runs[run]) if run in runs else None
    except (ValueError, KeyError, TypeError) as error:
        raise InputError(f"{path}: expected the measures of runs: {error!r}") from error


def _parsed(of_run: Mapping[str, Any]) -> tuple[RewardLandscape, tuple[ScaleTuning, ...]]:
    landscape = of_run["landscape"]
    errors = [landscape[f"reconstruction_error_{scale}"] for scale in SCALES]
    return (
        RewardLandscape(
            np.array(landscape["vergence_error_deg"]),
            np.array(errors, dtype=np.float64).T,
            _read(of_run["left_share"]),
            np.full((len(SCALES), 0), np.nan),
        ),
        tuple(
            ScaleTuning(**{name: _read(value) for name, value in of_run[scale].items()})
            for scale in SCALES
        ),
    )


def _read(value: Any) -> Any:
    """Return what `_plain` was given."""
    if isinstance(value, list):
        return np.array(value)
    return math.nan if value is None else value


def _plain(value: Any) -> Any:
    """Return numbers as JSON has them, with six decimals; None stands for nan."""
    if isinstance(value, np.ndarray):
        return [_plain(number) for number in value.tolist()]
    if isinstance(value, int):
        return value
    return round(float(value), 6) if math.isfinite(value) else None
