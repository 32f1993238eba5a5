"""What is held before the eyes, and what it adds to what they wear."""

import math

import pytest

from active_binocular_vision.examinations.contract.declared import TrialFrame
from active_binocular_vision.examinations.contract.trial_frame import behind, held
from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.session import session_of
from active_binocular_vision.learners.shown import Shown
from eye_plant.camera.config import CameraConfig
from eye_plant.config import EyesConfig
from eye_plant.lens.config import LensesConfig
from tests.active_binocular_vision.perfect_eyes import perfect_eyes

_WORN = EyesConfig(
    camera=CameraConfig(left_rotation_deg=1.0),
    lenses=LensesConfig(contact_lenses_d=(1.0, -2.0), pinhole_mm=(8.0, 1.0)),
)


def test_an_empty_frame_changes_nothing() -> None:
    assert held(_WORN, TrialFrame()) == {}


def test_lenses_and_prisms_add_to_what_is_worn_and_the_smaller_hole_counts() -> None:
    frame = TrialFrame(lenses_d=(0.5, 0.5), prisms_pd=(10.0, 0.0), pinholes_mm=(2.0, 2.0))
    assert held(_WORN, frame) == {
        "camera.left_rotation_deg": pytest.approx(1.0 - math.degrees(math.atan(0.1))),
        "lenses.contact_lenses_d": (1.5, -1.5),
        "lenses.pinhole_mm": (2.0, 1.0),
    }


@pytest.mark.parametrize("kind", ["pair", "gaze", "triad"])
def test_eyes_converge_through_prisms_with_the_base_out(run_of, kind) -> None:
    learners = behind(FrozenLearners(run_of(kind)), TrialFrame(prisms_pd=(2.0, 3.0)), "")
    with session_of(learners, Shown(), 1) as session, perfect_eyes():
        course = session.eyes(0, 2.0).look(1)
    more_deg = sum(math.degrees(math.atan(pd / 100.0)) for pd in (2.0, 3.0))
    assert course.seen_deg[-1, 0] == pytest.approx(0.0, abs=2e-3)
    assert course.eyes_deg[-1, 0] == pytest.approx(-more_deg, abs=2e-3)
