"""Eyes in a session: what is shown, where they begin, and what a cover or a prism does."""

from pathlib import Path

import numpy as np
import pytest

from active_binocular_vision.examinations.clinic.prisms import DIRECTIONS
from active_binocular_vision.learners.session import Prism, is_fused
from active_binocular_vision.learners.shown import Shown
from eye_plant import load_stimuli
from eye_plant.stimuli.stimulus_set import StimuliConfig
from tests.active_binocular_vision.moved_eyes import moved_eyes

KINDS = ("pair", "twelve", "gaze")


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("error_deg", [0.0, -0.5, 1.0])
def test_eyes_begin_with_the_error_that_is_asked_for(session_with, kind, error_deg) -> None:
    first = session_with(kind).eyes(0, 2.0, error_deg).look(1)
    np.testing.assert_allclose(first.seen_deg[0], (error_deg, 0.0, 0.0), atol=2e-3)
    np.testing.assert_array_equal(first.seen_deg, first.eyes_deg)


@pytest.mark.parametrize("kind", KINDS)
def test_a_stereogram_is_looked_at_where_it_fuses(session_with, kind) -> None:
    session = session_with(kind, Shown(random_dots=True, n_most=3))
    errors_deg = [session.eyes(i, 1.0, 0.1).look(1).seen_deg[0] for i in range(session.n_pictures)]
    np.testing.assert_allclose(errors_deg, [(0.1, 0.0, 0.0)] * 3, atol=2e-3)


@pytest.mark.parametrize("turn", ["left_rotation_deg", "left_elevation_deg", "right_elevation_deg"])
def test_the_left_camera_of_eyes_that_make_saccades_looks_straight_ahead(session_with, turn):
    session = session_with("gaze", **{f"camera.{turn}": -2.0})
    first = session.eyes(0, 0.5, 0.3).look(1)
    np.testing.assert_allclose(first.seen_deg[0], (0.3, 0.0, 0.0), atol=2e-3)
    aside_deg = np.degrees(np.arccos(first.lines_of_sight[0, 0, 0]))
    assert aside_deg == pytest.approx(2.0 if "left" in turn else 0.0, abs=0.01)


def test_eyes_without_saccades_begin_alike(session_with) -> None:
    both = session_with("twelve").eyes(0, 0.5).look(1).lines_of_sight[0]
    np.testing.assert_allclose(both[0], both[1] * (1.0, -1.0, 1.0), atol=1e-4)


def test_fixations_are_whole(session_with) -> None:
    gaze = session_with("gaze").eyes(0, 2.0)
    assert [gaze.look(n).n_iterations for n in (3, 10, 13, 20)] == [3, 10, 20, 20]
    assert session_with("pair").eyes(0, 2.0).look(13).n_iterations == 13


@pytest.mark.parametrize("direction", DIRECTIONS, ids=lambda d: d.name)
def test_a_prism_asks_for_what_its_name_says(session_with, direction) -> None:
    # Eyes that have not followed yet lag by the whole demand, about this axis alone.
    seen_deg = session_with("pair").eyes(0, 6.0).look(1, prism=direction.prism(1.5)).seen_deg[0]
    assert direction.lag_deg(seen_deg) == pytest.approx(1.5, abs=1e-3)
    others = np.delete(seen_deg, direction.i_error)
    np.testing.assert_allclose(others, (0.0, 0.0), atol=1e-2)


@pytest.mark.parametrize(("name", "way"), [("base out", -1.0), ("base in", 1.0)])
def test_eyes_that_follow_a_horizontal_prism_see_no_disparity(session_with, name, way) -> None:
    # Base out asks for convergence: an error below 0.
    (direction,) = (d for d in DIRECTIONS if d.name == name)
    course = session_with("twelve").eyes(0, 2.0, way * 2.0).look(1, prism=direction.prism(2.0))
    assert direction.lag_deg(course.seen_deg[0]) == pytest.approx(0.0, abs=5e-3)
    assert direction.response_deg(course.eyes_deg[0], np.zeros(3)) == pytest.approx(2.0, abs=5e-3)


def test_a_prism_adds_to_the_eyes_own_camera_and_is_gone_afterwards(session_with) -> None:
    session = session_with("pair", **{"camera.right_rotation_deg": 3.0})
    seen_deg = [
        session.eyes(0, 2.0).look(1, prism=prism).seen_deg[0, 0]
        for prism in (Prism(rotation_deg=1.0), Prism(rotation_deg=-1.0), Prism())
    ]
    np.testing.assert_allclose(seen_deg, (-4.0, -2.0, -3.0), atol=0.01)


def test_eyes_with_commands_of_their_own_begin_with_the_error_that_turned_cameras_see(
    session_with,
) -> None:
    session = session_with("twelve", **{"camera.right_rotation_deg": -3.0})
    first = session.eyes(0, 2.0, 0.5).look(1)
    np.testing.assert_allclose(first.seen_deg[0], (0.5, 0.0, 0.0), atol=2e-3)
    assert first.eyes_deg[0, 0] == pytest.approx(-2.5, abs=0.01)


def test_a_cover_hides_the_picture_of_one_eye_only(session_with) -> None:
    session = session_with("pair")
    eyes = session.eyes(0, 2.0)
    eyes.look(1, covered="right")
    assert session.loop.plant.config.camera.occlusions == (False, True)
    eyes.look(1)
    assert session.loop.plant.config.camera.occlusions == (False, False)
    # The code of what is seen after it: neither half is empty.
    halves = eyes.code().patches[0].reshape(-1, 2, 64)
    assert (np.abs(halves).sum(axis=(0, 2)) > 0.0).all()


def test_fused_is_below_a_pixel_sideways_and_up() -> None:
    errors_deg = np.array([(0.1, -0.1, 9.0), (-0.3, 0.0, 0.0), (0.0, 0.3, 0.0)])
    assert is_fused(errors_deg, 0.2).tolist() == [True, False, False]


def test_two_parts_are_as_one(session_with) -> None:
    session = session_with("twelve")
    with moved_eyes(lambda features, _: 0.001 * np.ravel(features)[:12] / features.max()):
        whole = session.eyes(0, 1.0).look(4).seen_deg
        parted = session.eyes(0, 1.0)
        parts = [parted.look(1).seen_deg[:-1], parted.look(3).seen_deg]
    np.testing.assert_allclose(np.concatenate(parts), whole, atol=1e-6)
    assert np.abs(np.diff(whole, axis=0)).max(axis=1).min() > 1e-3


@pytest.mark.parametrize(("kind", "nearest_m"), [("pair", 0.1), ("twelve", 0.3)])
def test_planes_to_which_the_muscles_converge_are_shown(session_with, kind, nearest_m) -> None:
    session = session_with(kind)
    assert session.shows(nearest_m)
    assert session.shows(nearest_m - 0.01) == (kind == "pair")


def test_of_generated_stimuli_only_those_that_are_shown_are_made(tmp_path: Path) -> None:
    config = StimuliConfig(n_training=3, n_test=4, size_px=64, cache_directory=str(tmp_path))
    shown = Shown(n_most=2).load(config, 1)
    assert len(list(tmp_path.rglob("test_*.npy"))) == 2
    np.testing.assert_array_equal(shown.test, load_stimuli(config).test[:2])
    assert len(Shown(n_most=9).load(config, 1).test) == 4
