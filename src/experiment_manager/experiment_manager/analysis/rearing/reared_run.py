"""What a run has become: its results, and what its newest checkpoint has learned."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from experiment_manager.analysis.rearing.reward_landscape import RewardLandscape
from experiment_manager.measures.results import Results

Array = NDArray[np.float64]


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
    preferred_disparities_deg: Array


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
