"""Acuity and shares in the code of eyes that see little."""

import pytest

from active_binocular_vision import FrozenLearners
from active_binocular_vision.examinations.clinic.acuity import ACUITY
from active_binocular_vision.learners.shown import Shown
from lockstep import SIDES


def _measures(run, **settings):
    learners = FrozenLearners(run, settings=settings)
    return ACUITY(learners, Shown(n_most=1), distances_m=(2.0,)).measures()


def test_a_blurred_eye_has_a_lower_acuity_and_less_of_the_code(run_of) -> None:
    found = _measures(run_of("pair"), **{"camera.right_blur_px": 100.0})
    explained = {
        side: [row["explained_share"] for row in found["gratings"] if row["eye"] == side]
        for side in SIDES
    }
    assert max(explained["right"]) < 0.02 < min(explained["left"])
    assert found["summary"]["right_acuity_cycles_per_deg"] is None
    left, right = (row["share_in_code"] for row in found["eyes"])
    assert left + right == pytest.approx(1.0)


def test_eyes_that_are_both_covered_have_no_shares_in_the_code(run_of) -> None:
    found = _measures(run_of("pair"), **{f"camera.{side}_occluded": True for side in SIDES})
    assert [row["share_in_code"] for row in found["eyes"]] == [None, None]
    assert found["summary"]["left_share_in_code"] is None
