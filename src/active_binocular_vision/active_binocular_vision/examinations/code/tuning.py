"""What the basis functions are tuned to: Gabor fits, orientation, binocularity, disparity."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from active_binocular_vision.examinations.contract.declared import DECLARED, Options
from active_binocular_vision.examinations.contract.examination import Examination, Findings
from active_binocular_vision.examinations.contract.measure import SHARE, key, measure
from active_binocular_vision.learners.basis_functions import Tuning
from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.shown import Shown
from eye_plant.vergence import degrees_per_px
from lockstep import InputError
from lockstep.scales import SCALES

_N_SAMPLES = 12
_SAMPLE_DECIMALS = 3


@dataclass(frozen=True, kw_only=True)
class ScaleRow:
    """The basis functions of one scale.

    Shares of all its basis functions; binocular_share of the Gabor functions, null without any.
    Counts are of the Gabor functions: (8,) orientations from horizontal on, (7,) bins of
    binocularity from left to right. preferred_disparities_deg: of those that have one, rising.
    samples: (12, 128) basis functions from the best to the worst Gabor fit; null
    where they were not kept.
    """

    scale: str = key("scale")
    gabor_share: float = measure(SHARE, "Gabor functions")
    common_gabor_share: float = measure(SHARE, "common to both eyes")
    binocular_share: float | None = measure(SHARE, "binocular")
    orientation_counts: Sequence[int] = measure("", "orientations", is_shown=False)
    binocularity_counts: Sequence[int] = measure("", "binocularity", is_shown=False)
    preferred_disparities_deg: Sequence[float] = measure("deg", "disparities", is_shown=False)
    samples: Sequence[Sequence[float]] | None = measure("", "samples", is_shown=False)


def of_scales(unit: str, name: str, label: str) -> Any:
    """Declare a measure with a value for each of K17's scales; more have none in a summary."""
    columns = tuple(f"{name}_{scale}" for scale in SCALES)
    labels = tuple(f"{label}, {scale}" for scale in SCALES)
    return measure(unit, label, columns=columns, labels=labels)


@dataclass(frozen=True, kw_only=True)
class TuningSummary:
    """Shares of the first two scales."""

    gabor_share: Sequence[float] = of_scales(SHARE, "gabor_share", "Gabor")
    common_gabor_share: Sequence[float] = of_scales(SHARE, "common_gabor_share", "common")
    binocular_share: Sequence[float] = of_scales(SHARE, "binocular_share", "binocular")


def _examine(learners: FrozenLearners, shown: Shown, _: Options) -> Findings:
    """Fit the basis functions; no picture is shown."""
    if shown.text:
        raise InputError("--tuning: expected no stimuli, since the dictionary alone is examined")
    px_deg = degrees_per_px(learners.plant.camera.focal_length_px)
    rows = [
        scale_row(scale, tuned, atoms, px_deg)
        for scale, tuned, atoms in zip(
            learners.manager.scales.names, learners.tunings, learners.atoms, strict=True
        )
    ]

    def of_rows(value: Callable[[ScaleRow], Any]) -> list[Any]:
        return [value(row) for row in rows[: len(SCALES)]]

    return Findings(
        n_stimuli=0,
        summary=TuningSummary(
            gabor_share=of_rows(lambda row: row.gabor_share),
            common_gabor_share=of_rows(lambda row: row.common_gabor_share),
            binocular_share=of_rows(lambda row: row.binocular_share),
        ),
        tables={"scales": rows},
        titles={"scales": ""},
    )


def scale_row(scale: str, tuned: Tuning, atoms: NDArray[Any], px_deg: float) -> ScaleRow:
    """Return what is kept of the tuning of a scale's atoms (n_bases, 128).

    px_deg: visual angle of a pixel; disparities become angles at the picture's centre.
    """
    known_px = tuned.disparity_px[~np.isnan(tuned.disparity_px)]
    chosen = np.linspace(0, len(atoms) - 1, _N_SAMPLES).astype(int)
    samples = atoms[tuned.residual.argsort()[chosen]].astype(np.float64)
    return ScaleRow(
        scale=scale,
        gabor_share=float(tuned.is_gabor.mean()),
        common_gabor_share=float(tuned.is_common_gabor.mean()),
        binocular_share=tuned.binocular_share,
        orientation_counts=tuned.orientation_counts().tolist(),
        binocularity_counts=tuned.binocularity_counts().tolist(),
        preferred_disparities_deg=np.sort(known_px * px_deg).tolist(),
        samples=np.round(samples, _SAMPLE_DECIMALS).tolist(),
    )


TUNING = Examination(
    declared=DECLARED["tuning"],
    examine=_examine,
    summary=TuningSummary,
)
