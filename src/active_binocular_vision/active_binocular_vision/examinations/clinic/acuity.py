"""Acuity of each eye, and each eye's share in the code (suppression)."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from active_binocular_vision.examinations.clinic.gratings import (
    Resolution,
    resolution,
    rival_shares,
)
from active_binocular_vision.examinations.contract.declared import DECLARED, Distances
from active_binocular_vision.examinations.contract.examination import Examination, Findings
from active_binocular_vision.examinations.contract.measure import SHARE, key, measure
from active_binocular_vision.learners.basis_functions import left_share
from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.session import session_of
from active_binocular_vision.learners.shown import Shown
from lockstep import SIDES
from sparse_coder.suppression import gains

_N_PICTURES = 10
# Below this gain an eye is suppressed at a place (ours: a quarter of the energy of equal eyes).
_SUPPRESSED = 0.5


@dataclass(frozen=True, kw_only=True)
class EyeRow:
    """One eye; acuity null where it never explains half, share null where neither sees anything.

    interval_cycles_per_deg: 95 % of the acuity, over orientations and phases of gratings; 0 where
    half is not explained. gain: mean over all places; suppressed: those with a gain below a half.
    """

    eye: str = key("eye")
    acuity_cycles_per_deg: float | None = measure("cycles/deg", "acuity", 2)
    interval_cycles_per_deg: Sequence[float | None] = measure(
        "cycles/deg",
        "interval",
        2,
        columns=("acuity_low_cycles_per_deg", "acuity_high_cycles_per_deg"),
        labels=("from", "to"),
    )
    acuity_log_mar: float | None = measure("", "logMAR", 2)
    finest_cycles_per_deg: float = measure("cycles/deg", "finest grating", 2)
    share_in_code: float | None = measure(SHARE, "share in the code")
    share_of_rival: float = measure(SHARE, "of rival gratings")
    gain: float = measure("", "gain", 2)
    suppressed_share: float = measure(SHARE, "places suppressed")


@dataclass(frozen=True, kw_only=True)
class PlaceRow:
    """Gain of each eye at the place of one patch, counted row by row."""

    scale: str = key("scale")
    patch: int = key("patch")
    left_gain: float = measure("", "left gain", 2)
    right_gain: float = measure("", "right gain", 2)


@dataclass(frozen=True, kw_only=True)
class GratingRow:
    """Share of the gratings of one frequency that the code of one eye's picture explains."""

    eye: str = key("eye")
    cycles_per_deg: float = key("frequency", "cycles/deg")
    explained_share: float = measure(SHARE, "explained")


@dataclass(frozen=True, kw_only=True)
class AcuitySummary:
    """Both eyes; the left eye's share is 0.5 where neither is suppressed."""

    acuity_cycles_per_deg: Sequence[float | None] = measure(
        "cycles/deg",
        "acuity",
        2,
        columns=tuple(f"{side}_acuity_cycles_per_deg" for side in SIDES),
        labels=tuple(f"acuity {side}" for side in SIDES),
    )
    left_share_in_code: float | None = measure(SHARE, "left eye in code")
    suppressed_share: Sequence[float] = measure(
        SHARE,
        "suppressed",
        columns=tuple(f"{side}_suppressed_share" for side in SIDES),
        labels=tuple(f"suppressed {side}" for side in SIDES),
    )


def _examine(learners: FrozenLearners, shown: Shown, options: Distances) -> Findings:
    """Measure acuity with gratings, suppression with pictures at correct fixation."""
    with session_of(learners, shown, _N_PICTURES) as session:
        features = [
            session.eyes(i, distance_m).code().features
            for i in range(session.n_pictures)
            for distance_m in options.distances_m
        ]
        coder = session.loop.coder
        left = left_share(np.sum(features, axis=0), coder.atoms())
        seen = [resolution(coder, learners.plant.camera, i) for i, _ in enumerate(SIDES)]
        rival = rival_shares(coder, learners.plant.camera).tolist()
        of_places = [gains(dominance) for dominance in coder.dominances]
    everywhere = np.concatenate(of_places)
    suppressed = (everywhere < _SUPPRESSED).mean(axis=0).tolist()
    of_eyes = dict(zip(SIDES, seen, strict=True))
    shares = dict(zip(SIDES, (left, 1.0 - left), strict=True))
    return Findings(
        n_stimuli=session.n_pictures,
        summary=AcuitySummary(
            acuity_cycles_per_deg=[of.acuity for of in seen],
            left_share_in_code=None if math.isnan(left) else left,
            suppressed_share=suppressed,
        ),
        tables={
            "eyes": [
                EyeRow(
                    eye=side,
                    acuity_cycles_per_deg=of.acuity,
                    interval_cycles_per_deg=of.interval or (None, None),
                    acuity_log_mar=of.log_mar,
                    finest_cycles_per_deg=float(of.cycles_per_deg[-1]),
                    share_in_code=shares[side],
                    share_of_rival=rival[i],
                    gain=float(everywhere[:, i].mean()),
                    suppressed_share=suppressed[i],
                )
                for i, (side, of) in enumerate(of_eyes.items())
            ],
            "places": [
                PlaceRow(scale=scale.name, patch=i, left_gain=left_gain, right_gain=right_gain)
                for scale, of_scale in zip(coder.config.scales.all, of_places, strict=True)
                for i, (left_gain, right_gain) in enumerate(of_scale.tolist())
                if coder.config.suppression_iterations
            ],
            "gratings": [row for side, of in of_eyes.items() for row in _gratings(side, of)],
        },
        titles={"eyes": ""},
        traces=of_eyes,
    )


def _gratings(side: str, seen: Resolution) -> list[GratingRow]:
    pairs = zip(seen.cycles_per_deg, seen.explained, strict=True)
    return [GratingRow(eye=side, cycles_per_deg=f, explained_share=share) for f, share in pairs]


ACUITY = Examination(
    declared=DECLARED["acuity"],
    examine=_examine,
    summary=AcuitySummary,
)
