"""Acuity of each eye, stereo threshold, and each eye's share in the code (suppression)."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from active_binocular_vision.examinations.gratings import Resolution, resolution
from active_binocular_vision.examinations.room import Room, examination_room
from active_binocular_vision.examinations.stereo import StereoCurve, stereo_curve
from active_binocular_vision.learners.basis_functions import left_share
from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.shown import OWN_TEST_STIMULI, Shown
from experiment_manager.measures.tables import number, percent, text_table
from lockstep import SIDES

DISTANCES_M = (0.5, 2.0, 6.0)
_N_PICTURES = 10
_N_STEREOGRAMS = 10
_ARCSEC_PER_DEG = 3600.0
_SIGNS = ("", "_converged_too_much", "_converged_too_little")


@dataclass(frozen=True)
class AcuityResults:
    """What frozen learners resolve.

    stimuli: of left_share, in words, "" for the run's own; resolutions: of left and right eye;
    left_share: the left eye's share in the code of pictures at correct fixation, 0.5 where neither
    eye is suppressed, nan where neither sees anything.
    """

    learners: FrozenLearners
    stimuli: str
    n_stimuli: int
    resolutions: tuple[Resolution, Resolution]
    stereo: StereoCurve
    left_share: float

    def to_json(self) -> dict[str, Any]:
        """Return what evaluate.sh writes."""
        threshold_deg = self.stereo.threshold_deg
        return self.learners.said() | {
            "examination": "acuity",
            "stimuli": self.stimuli,
            "n_stimuli": self.n_stimuli,
            "acuity": {
                side: {
                    "acuity_cycles_per_deg": seen.acuity,
                    "cycles_per_deg": seen.cycles_per_deg.tolist(),
                    "explained_share": seen.explained.tolist(),
                }
                for side, seen in zip(SIDES, self.resolutions, strict=True)
            },
            "stereo": {
                "threshold_deg": threshold_deg,
                "threshold_arcsec": None
                if threshold_deg is None
                else threshold_deg * _ARCSEC_PER_DEG,
                "disparity_deg": self.stereo.disparity_deg.tolist(),
                "share_right": self.stereo.right.tolist(),
                "share_right_converged_too_much": self.stereo.right_by_sign[0].tolist(),
                "share_right_converged_too_little": self.stereo.right_by_sign[1].tolist(),
                "n_trials_each": self.stereo.n_trials,
            },
            "share_in_code": {
                side: None if math.isnan(share) else share
                for side, share in zip(SIDES, (self.left_share, 1.0 - self.left_share), strict=True)
            },
        }

    def table(self) -> str:
        """Return the measures as text."""
        document = self.to_json()
        stereo = document["stereo"]
        eyes = text_table(
            ("eye", "acuity/(cycles/deg)", "finest grating", "share in the code"),
            [
                (
                    side,
                    number(of_eye["acuity_cycles_per_deg"], 2),
                    number(of_eye["cycles_per_deg"][-1], 2),
                    percent(document["share_in_code"][side]),
                )
                for side, of_eye in document["acuity"].items()
            ],
        )
        names = [f"share_right{which}" for which in _SIGNS]
        rows = zip(stereo["disparity_deg"], *(stereo[name] for name in names), strict=True)
        curve = text_table(
            ("disparity/deg", "right", "eyes converge too much", "too little"),
            [(f"{size_deg:g}", *map(percent, shares)) for size_deg, *shares in rows],
        )
        threshold = (
            "no stereo threshold: fewer than 75 % are right at the largest disparity"
            if stereo["threshold_deg"] is None
            else f"stereo threshold {number(stereo['threshold_deg'])} deg, "
            f"{number(stereo['threshold_arcsec'], 0)} arcsec"
        )
        return f"{eyes}\n\n{curve}\n\n{threshold}"


def examine(learners: FrozenLearners, shown: Shown = OWN_TEST_STIMULI) -> AcuityResults:
    """Measure acuity with gratings, the stereo threshold with random dots, suppression with shown.

    Raises InputError as the cover test does.
    """
    with examination_room(learners, shown, _N_PICTURES) as room:
        share, n_pictures = _left_share(room), room.n_pictures
        left, right = (
            resolution(room.loop.coder, learners.plant.camera, i_eye)
            for i_eye, _ in enumerate(SIDES)
        )
    with examination_room(learners, Shown(random_dots=True), _N_STEREOGRAMS) as room:
        curve = stereo_curve(room, DISTANCES_M)
    return AcuityResults(learners, shown.text, n_pictures, (left, right), curve, share)


def _left_share(room: Room) -> float:
    """Return the left eye's share in the code of all pictures at correct fixation."""
    features = np.sum(
        [
            room.seat(i, distance_m).code().features
            for i in range(room.n_pictures)
            for distance_m in DISTANCES_M
        ],
        axis=0,
    )
    return left_share(features, room.loop.coder.atoms())
