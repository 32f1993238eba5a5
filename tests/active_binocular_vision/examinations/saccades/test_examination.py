"""evaluate.sh --main-sequence on a run with saccades that has hardly learned."""

import json
from collections.abc import Iterator
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest

from active_binocular_vision.commands.evaluate import main
from active_binocular_vision.examinations.saccades import examination
from active_binocular_vision.examinations.saccades.examination import (
    Saccades,
    examine_saccades,
    place_deg,
)
from active_binocular_vision.figures.main_sequence import main_sequence_figure
from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.shown import Shown
from eye_plant.gaze_error import target_place_deg
from lockstep import InputError
from lockstep.figures import STYLE
from tests.active_binocular_vision.moved_eyes import moved_eyes

AMPLITUDES_DEG = (2.0, 10.0)
DIRECTIONS_DEG = (0.0, 90.0)


@pytest.fixture(scope="module", autouse=True)
def few_that_move(gazing_run: Path) -> Iterator[None]:
    """Make few saccades, sideways alone, by eyes that have not learned any."""
    left_medial = np.eye(12)[0]
    with moved_eyes(lambda _, target_deg: 0.004 * target_deg[0] * left_medial) as patch:
        patch.setattr(examination, "AMPLITUDES_DEG", AMPLITUDES_DEG)
        patch.setattr(examination, "DIRECTIONS_DEG", DIRECTIONS_DEG)
        yield


@pytest.fixture(scope="module")
def found(gazing_run: Path, few_that_move: None) -> Saccades:
    return examine_saccades(FrozenLearners(gazing_run))


@pytest.mark.parametrize("direction_deg", [0.0, 45.0, 90.0, 180.0, 225.0])
def test_a_place_is_as_far_and_where_it_should_be(direction_deg: float) -> None:
    seen_deg = target_place_deg(np.eye(3), *place_deg(20.0, direction_deg).tolist())
    direction = np.radians(direction_deg)
    np.testing.assert_allclose(
        seen_deg, 20.0 * np.array([np.cos(direction), np.sin(direction)]), atol=1e-9
    )


def test_a_saccade_follows_its_command_and_creeps_after_the_period(found: Saccades) -> None:
    places = [(s.target_deg, s.direction_deg) for s in found.saccades]
    assert places == [(a, d) for a in AMPLITUDES_DEG for d in DIRECTIONS_DEG]
    small, _, large, upward = found.saccades
    forward, left, _ = large.movement.sight[-1]
    assert forward > 0.0 > left
    assert large.movement.amplitude_deg > 3.0 * small.movement.amplitude_deg
    assert 0.3 < large.share_in_period < 1.0
    # These eyes do not move up, so they miss by the whole distance.
    assert upward.movement.amplitude_deg < 0.01
    assert upward.missed_deg == pytest.approx(10.0, abs=0.05)


def test_the_document_has_each_saccade_and_the_fit(found: Saccades) -> None:
    document = found.to_json()
    assert json.loads(json.dumps(document, allow_nan=False)) == document
    assert document["control_period_s"] == pytest.approx(0.4)
    assert [s["target_deg"] for s in document["saccades"]] == [2.0, 2.0, 10.0, 10.0]
    slope_per_s = document["main_sequence"]["slope_per_s"]
    fastest = document["saccades"][2]
    ratio_per_s = fastest["peak_velocity_deg_s"] / fastest["amplitude_deg"]
    assert slope_per_s == pytest.approx(ratio_per_s, rel=0.1)


def test_the_figure_has_a_course_for_each_saccade_to_the_right(found: Saccades) -> None:
    with mpl.rc_context(STYLE):
        course, _ = main_sequence_figure(found).axes
    ends_deg = [float(np.asarray(line.get_ydata())[-1]) for line in course.lines[:2]]
    assert 0.0 < ends_deg[0] < ends_deg[1]


def test_the_command_prints_writes_and_draws(
    gazing_run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    figure, out = tmp_path / "figure.png", tmp_path / "saccades.json"
    line = [str(gazing_run), "--main-sequence", "--figure", str(figure), "--out", str(out)]
    assert main(line) == 0
    assert "within 400 ms" in capsys.readouterr().out
    assert figure.is_file()
    assert len(json.loads(out.read_text())["saccades"]) == 4


def test_eyes_that_have_not_learned_to_move_are_refused(gazing_run: Path) -> None:
    with (
        moved_eyes(lambda *_: np.zeros(12)),
        pytest.raises(InputError, match="expected learners that have learned saccades"),
    ):
        examine_saccades(FrozenLearners(gazing_run))


def test_stereograms_are_refused(gazing_run: Path) -> None:
    with pytest.raises(InputError, match="--main-sequence: expected pictures on a plane"):
        examine_saccades(FrozenLearners(gazing_run), Shown(random_dots=True))
