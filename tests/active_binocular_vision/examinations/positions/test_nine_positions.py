"""evaluate.sh --nine-positions on a run with saccades that has hardly learned."""

import json
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from active_binocular_vision.commands.evaluate import main
from active_binocular_vision.examinations.positions import document as documents
from active_binocular_vision.examinations.positions.document import NinePositions, document
from active_binocular_vision.examinations.positions.examination import Examined, examine
from active_binocular_vision.examinations.positions.measures import planes_of_eyes, yoked_changes
from active_binocular_vision.examinations.positions.targets import (
    wanted_angles_deg,
    wanted_gaze_deg,
)
from active_binocular_vision.figures.nine_positions import listing_figure
from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.shown import OWN_TEST_STIMULI, Shown
from active_binocular_vision.learners.viewing import Viewing
from experiment_manager.experiment.starts import gaze_inverse
from eye_plant import GazeInverse
from eye_plant.mechanics.oculomotor import Oculomotor
from lockstep import MUSCLE_NAMES, SIDES
from tests.active_binocular_vision.moved_eyes import moved_eyes

DISTANCES_M = (0.5, 6.0)
N_RANDOM = 5
LEFT_ELEVATORS = "left_superior_rectus", "left_inferior_oblique"
UPPER_LEFT, MIDDLE, LOWER_LEFT = 0, 4, 6


@pytest.fixture(scope="module")
def run(gazing_run: Path) -> Path:
    return gazing_run


@pytest.fixture(scope="module", autouse=True)
def moving(run: Path) -> Iterator[None]:
    """Let eyes that have not learned move: by what they see, and by where a target is."""

    def change(features: np.ndarray, target_deg: np.ndarray) -> np.ndarray:
        seen = np.array([part.sum() for part in np.array_split(np.ravel(features), 12)])
        found = 0.005 * (seen - seen.mean())
        found[0] += 0.001 * np.nan_to_num(target_deg).sum()
        return found

    with moved_eyes(change):
        yield


@pytest.fixture(scope="module")
def examined(run: Path, moving: None) -> Examined:
    return examine(FrozenLearners(run), distances_m=DISTANCES_M, n_random=N_RANDOM)


@pytest.fixture
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the command look at few places."""
    fewer = partial(examine, distances_m=DISTANCES_M[:1], n_random=N_RANDOM)
    monkeypatch.setattr(documents, "examine", fewer)


def test_what_is_looked_at(examined: Examined) -> None:
    assert examined.n_pictures == 2
    assert examined.nine.pictures.tolist() == [[0, 1]] * 9
    assert examined.random.pictures.ravel().tolist() == [0, 1, 0, 1, 0]
    assert examined.nine.eyes.rotations.shape == (2, 9, 2, 2, 3, 3)
    assert examined.random.eyes.activations.shape == (2, N_RANDOM, 1, 12)


def _positions_m(examined: Examined) -> np.ndarray:
    return Oculomotor(examined.learners.manager.mechanics).eye_positions_m()


def test_a_look_ends_where_an_episode_from_straight_ahead_does(examined: Examined) -> None:
    learners = examined.learners
    inverse = gaze_inverse(learners.manager, learners.manager.mechanics)
    ahead_deg = wanted_angles_deg(wanted_gaze_deg(_positions_m(examined), (0.0, 0.0), 0.5))
    first = inverse.activations(ahead_deg, 0.5, np.zeros(12))
    with learners.loop(OWN_TEST_STIMULI.load(learners.plant.stimuli, 2)) as loop:
        looks = Viewing(loop, 1, 0.5, first.tolist()).look(20, targets_deg=(-8.0, -8.0) * 2)
    assert np.abs(looks[-1].state.activations - first).max() > 0.01
    begin, end = looks[0].truth, looks[-1].truth
    assert np.hypot(*begin.target_deg) == pytest.approx(np.hypot(8.0, 8.0), abs=0.1)
    found = {n: values[0, LOWER_LEFT, 1] for n, values in examined.nine.eyes.readings().items()}
    expected = {
        "left_azimuth_deg": end.adduction_deg[0],
        "left_elevation_deg": end.elevation_deg[0],
        "right_azimuth_deg": -end.adduction_deg[1],
        "right_elevation_deg": end.elevation_deg[1],
        "left_torsion_deg": end.torsion_deg[0],
        "right_torsion_deg": end.torsion_deg[1],
        "horizontal_error_deg": end.gaze_error.horizontal_deg,
        "vertical_error_deg": end.gaze_error.vertical_deg,
        "cyclovergence_error_deg": end.gaze_error.torsional_deg,
        "missed_deg": np.hypot(*end.target_deg),
        "metabolic_rate_w": end.metabolic_rate_w,
    }
    activations = looks[-1].state.activations
    expected |= dict(zip(MUSCLE_NAMES, activations.tolist(), strict=True))
    assert found == pytest.approx(expected, abs=1e-9)
    assert examined.nine.eyes.vergence_deg[0, LOWER_LEFT, 1] == pytest.approx(
        sum(end.adduction_deg)
    )


def test_the_least_energy_looks_at_the_targets_without_errors(examined: Examined) -> None:
    for gazes in (examined.nine, examined.random):
        assert np.abs(gazes.optimum.errors_deg).max() < 1e-3
        assert gazes.optimum.missed_deg.max() < 1e-3
        assert (gazes.eyes.metabolic_rate_w > gazes.optimum.metabolic_rate_w[..., None]).all()
    protocol = examined.learners.manager
    inverse = GazeInverse(
        examined.learners.manager.mechanics, protocol.space, protocol.limits.lowest, np.ones(12)
    )
    wanted_deg = wanted_angles_deg(wanted_gaze_deg(_positions_m(examined), (-8.0, 8.0), 6.0))
    least = inverse.least(wanted_deg, 6.0)
    at = 1, UPPER_LEFT
    assert examined.nine.optimum.metabolic_rate_w[at] == pytest.approx(least.metabolic_rate_w)
    np.testing.assert_allclose(examined.nine.optimum.activations[at], least.activations)


def test_the_document_has_all_looks_and_their_medians(examined: Examined) -> None:
    found = document(examined)
    assert json.loads(json.dumps(found, allow_nan=False)) == found
    assert [len(entry["looks"]) for entry in found["positions"]] == [2] * 18
    assert [len(entry["looks"]) for entry in found["random"]] == [1] * 10
    entry = found["positions"][9 + MIDDLE]
    rates_w = [look["metabolic_rate_w"] for look in entry["looks"]]
    ratio = np.mean(rates_w) / entry["least"]["metabolic_rate_w"]
    assert entry["cost_ratio"] == pytest.approx(ratio)
    far = [e["cost_ratio"] for e in found["positions"][9:]]
    assert found["summary"]["6"]["cost_ratio"] == pytest.approx(np.median(far))
    assert set(found["summary"]) == {"0.5", "6", "all"}
    assert found["antagonists"]["all"]["share_silent_in_optimum"] == 1.0
    left, right = (found["listing"]["least"][side] for side in ("left", "right"))
    assert set(left["by_distance"]) == {"0.5", "6"}
    # Without cyclovergence errors both planes turn to the same side of the head.
    assert left["tilt_per_vergence"] == pytest.approx(-right["tilt_per_vergence"], abs=0.02)


def test_yoked_changes_are_around_each_distance(examined: Examined) -> None:
    optimum = examined.random.optimum
    names = "left_lateral_rectus", "right_medial_rectus"
    first, second = (
        a - a.mean(axis=1, keepdims=True)
        for a in (optimum.activations[..., MUSCLE_NAMES.index(name)] for name in names)
    )
    change = yoked_changes(optimum, DISTANCES_M)["right_medial_rectus-left_lateral_rectus"]
    assert change.slope == pytest.approx((first * second).sum() / (second**2).sum())


def test_the_figure_of_listings_law_has_each_gaze_once_and_the_planes(examined: Examined) -> None:
    figure = listing_figure(examined)
    planes = planes_of_eyes(examined)
    panels = iter(figure.axes)
    for i, distance_m in enumerate(DISTANCES_M):
        for i_side, side in enumerate(SIDES):
            axes = next(panels)
            dots = [line for line in axes.lines if line.get_linestyle() == "None"]
            shown_deg = np.concatenate([np.asarray(line.get_ydata()) for line in dots])
            of_nine = examined.nine.eyes.rotation_vectors[i, :, :, i_side, 0].mean(axis=1)
            of_random = examined.random.eyes.rotation_vectors[i, :, 0, i_side, 0]
            expected_deg = 2.0 * np.degrees(np.arctan([*of_nine, *of_random]))
            np.testing.assert_allclose(np.sort(shown_deg), np.sort(expected_deg), atol=1e-9)
            plane = planes[side].by_distance[distance_m]
            assert plane is not None
            assert axes.get_title(loc="left").endswith(f"thickness {plane.thickness_deg:.2f} deg")


@pytest.mark.usefixtures("few")
def test_the_command_prints_writes_and_draws(run, tmp_path, capsys) -> None:
    out, figure = tmp_path / "out.json", tmp_path / "chart.png"
    line = [str(run), "--nine-positions", "--stimuli-per-test", "1"]
    assert main([*line, "--out", str(out), "--figure", str(figure)]) == 0
    text = capsys.readouterr().out
    assert "1 pictures of its own test stimuli" in text
    assert "Medians over pictures after 20 iterations (angles" in text
    for title in ("Silent antagonists", "Displacement planes", "Yoked muscles"):
        assert title in text
    assert figure.exists()
    assert (tmp_path / "chart_activations.png").exists()
    assert (tmp_path / "chart_listing.png").exists()
    medians = json.loads(out.read_text())["summary"]["all"]
    assert f"{medians['missed_deg']:.3f}" in text


@pytest.mark.usefixtures("few")
def test_gazes_that_a_palsy_makes_impossible_have_no_least(run, tmp_path, capsys) -> None:
    out = tmp_path / "out.json"
    strength = [float(name not in LEFT_ELEVATORS) for name in MUSCLE_NAMES]
    line = [str(run), "--nine-positions", "--stimuli-per-test", "1", "--out", str(out)]
    line += ["--set", f"eyes.mechanics.strength={strength}", "--json"]
    assert main([*line, "--figure", str(tmp_path / "chart.png")]) == 0
    found = json.loads(out.read_text())
    assert json.loads(capsys.readouterr().out) == found
    by_target = {tuple(entry["target_deg"]): entry for entry in found["positions"]}
    for up_deg in ((0.0, 8.0), (8.0, 8.0)):
        assert by_target[up_deg]["least"] is by_target[up_deg]["cost_ratio"] is None
    for down_deg in ((-8.0, -8.0), (0.0, -8.0), (8.0, -8.0)):
        assert by_target[down_deg]["cost_ratio"] > 1.0


def test_a_covered_right_eye_ends_elsewhere(run: Path, examined: Examined) -> None:
    covered = examine(
        FrozenLearners(run), Shown(n_most=1), "right", distances_m=(0.5,), n_random=N_RANDOM
    )
    assert "after 20 iterations, right eye covered" in NinePositions(covered).table()
    seen, unseen = (e.nine.eyes.activations[0, :, 0] for e in (examined, covered))
    assert (np.abs(seen - unseen).max(axis=1) > 1e-6).all()


def test_what_cannot_be_examined_is_one_line(run, small_run, capsys) -> None:
    for line, message in (
        ((str(run), "--cover-eye", "left"), "--cover-eye: expected right, since the target is"),
        ((str(run), "--random-dots"), "--nine-positions: expected pictures on a plane"),
        (
            (str(run), "--figure", "chart.jpg"),
            "error: --figure: expected a name that ends in .png, got chart.jpg",
        ),
        ((str(small_run),), "expected eyes that make saccades, as those of profile gaze"),
    ):
        assert main([*line, "--nine-positions"]) == 2
        error = capsys.readouterr().err
        assert message in error
        assert error.count("\n") == 1
