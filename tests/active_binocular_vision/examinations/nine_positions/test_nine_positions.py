"""Where eyes are to look, which antagonists are silent and how yoked muscles change, by hand."""

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from active_binocular_vision import FrozenLearners
from active_binocular_vision.examinations.nine_positions.examination import NINE_POSITIONS
from active_binocular_vision.examinations.nine_positions.looking import (
    NINE_POSITIONS_DEG,
    NinePositionsTraces,
    random_targets_deg,
)
from active_binocular_vision.examinations.nine_positions.measures import (
    planes_of_eyes,
    rows_of_antagonists,
    yoked_changes,
)
from active_binocular_vision.figures.examinations.nine_positions import listing_figure
from active_binocular_vision.learners.shown import Shown
from eye_plant.gaze_error import wanted_gaze_deg
from lockstep import MUSCLE_NAMES, SIDES
from tests.active_binocular_vision.moved_eyes import moved_eyes

POSITIONS_M = np.array([[0.0, 0.03, 1.7], [0.0, -0.03, 1.7]])
MEDIAL, LATERAL, LEFT_IO = 0, 1, 5
HORIZONTAL = "left_medial_rectus-left_lateral_rectus"
OBLIQUES = "left_superior_oblique-left_inferior_oblique"
DISTANCES_M = (0.5, 6.0)


@pytest.fixture(scope="module")
def moving() -> Iterator[None]:
    """Let eyes that have not learned move: by what they see, and by where a target is."""

    def change(features: np.ndarray, target_deg: np.ndarray) -> np.ndarray:
        seen = np.array([part.sum() for part in np.array_split(np.ravel(features), 12)])
        found = 0.005 * (seen - seen.mean())
        found[0] += 0.001 * np.nan_to_num(target_deg).sum()
        return found

    with moved_eyes(change):
        yield


@pytest.fixture(scope="module")
def examine(gazing_run: Path, moving: None) -> Callable[..., NinePositionsTraces]:
    """Return a function that examines these eyes with one picture."""

    def examined(**options: object) -> NinePositionsTraces:
        found = NINE_POSITIONS(FrozenLearners(gazing_run), Shown(n_most=1), n_random=4, **options)
        traces: NinePositionsTraces = found.traces
        return traces

    return examined


@pytest.fixture(scope="module")
def traces(examine: Callable[..., NinePositionsTraces]) -> NinePositionsTraces:
    return examine(distances_m=DISTANCES_M)


def test_the_right_eye_looks_where_the_left_one_does() -> None:
    left_deg, right_deg = wanted_gaze_deg(POSITIONS_M, (0.0, 0.0), 0.5)
    np.testing.assert_allclose(left_deg, (0.0, 0.0), atol=1e-12)
    np.testing.assert_allclose(right_deg, (-np.degrees(np.arctan(0.06 / 0.5)), 0.0), atol=1e-12)
    # 45 deg up from the left eye: 1 m above its height; the right eye sees that from farther away.
    left_deg, right_deg = wanted_gaze_deg(POSITIONS_M, (0.0, 45.0), 1.0)
    np.testing.assert_allclose(left_deg, (0.0, 45.0))
    np.testing.assert_allclose(right_deg[1], np.degrees(np.arctan(1.0 / np.hypot(1.0, 0.06))))


def test_targets_are_the_same_for_all() -> None:
    targets_deg = random_targets_deg(40)
    np.testing.assert_array_equal(targets_deg[:7], random_targets_deg(7))
    assert np.abs(targets_deg).max() <= 10.0
    assert (np.abs(targets_deg) > 8.0).any(axis=0).all()
    assert NINE_POSITIONS_DEG.tolist()[:4] == [[-8, 8], [0, 8], [8, 8], [-8, 0]]


def test_silent_antagonists_by_hand() -> None:
    optimum, eyes = np.full((2, 12), 0.1), np.full((2, 3, 12), 0.1)
    optimum[0, MEDIAL] = optimum[1, [MEDIAL, LATERAL]] = 0.0
    # At the first gaze the right muscle, the wrong one and none; at the second both and none.
    eyes[0, 0, MEDIAL] = eyes[0, 1, LATERAL] = 0.004
    eyes[1, 2, [MEDIAL, LATERAL]] = 0.0
    eyes[0, :, LEFT_IO] = 0.0
    found = {row.antagonists: row for row in rows_of_antagonists(eyes, optimum, 0.005)}
    assert len(found) == 7
    horizontal, everything = found[HORIZONTAL], found["all"]
    assert horizontal.active == pytest.approx((3 / 6, 2 / 6, 1 / 6))
    assert horizontal.active_in_optimum == pytest.approx((0.0, 1 / 2, 1 / 2))
    assert horizontal.n_silent_in_optimum == 3
    # Three muscles before three pictures, of which three are silent.
    assert horizontal.share_optimally_silent == pytest.approx(3 / 9)
    assert found[OBLIQUES].active == pytest.approx((3 / 6, 3 / 6, 0.0))
    assert found[OBLIQUES].share_optimally_silent is None
    assert np.isnan(found[OBLIQUES].slope).all(), "no muscle varies"
    assert everything.active == pytest.approx((30 / 36, 5 / 36, 1 / 36))
    assert everything.active_in_optimum == pytest.approx((10 / 12, 1 / 12, 1 / 12))


def test_the_slope_of_antagonists_across_gaze_by_hand() -> None:
    optimum = np.zeros((3, 12))
    optimum[:, MEDIAL], optimum[:, LATERAL] = (0.1, 0.2, 0.3), (0.1, 0.05, 0.0)
    eyes = np.zeros((3, 1, 12))
    eyes[:, 0, MEDIAL] = (0.1, 0.2, 0.3)
    (row,) = (r for r in rows_of_antagonists(eyes, optimum, 0.005) if r.antagonists == HORIZONTAL)
    assert row.slope == pytest.approx([0.0, -0.5])


def test_the_least_energy_looks_at_the_targets_without_errors(traces: NinePositionsTraces) -> None:
    for gazes in (traces.nine, traces.random):
        assert np.abs(gazes.optimum.errors_deg).max() < 1e-3
        assert gazes.optimum.missed_deg.max() < 1e-3
        assert (gazes.eyes.metabolic_rate_w > gazes.optimum.metabolic_rate_w[..., None]).all()


def test_yoked_changes_are_around_each_distance(traces: NinePositionsTraces) -> None:
    optimum = traces.random.optimum
    names = "left_lateral_rectus", "right_medial_rectus"
    first, second = (
        a - a.mean(axis=1, keepdims=True)
        for a in (optimum.activations[..., MUSCLE_NAMES.index(name)] for name in names)
    )
    change = yoked_changes(optimum, DISTANCES_M)["right_medial_rectus-left_lateral_rectus"]
    assert change.slope == pytest.approx((first * second).sum() / (second**2).sum())


def test_the_figure_of_listings_law_has_each_gaze_once_and_the_planes(
    traces: NinePositionsTraces,
) -> None:
    planes = planes_of_eyes(traces)
    panels = iter(listing_figure(traces).axes)
    for distance_m in DISTANCES_M:
        for side in SIDES:
            axes = next(panels)
            dots = [line for line in axes.lines if line.get_linestyle() == "None"]
            assert sum(np.size(line.get_xdata()) for line in dots) == 9 + 4
            plane = planes[side].by_distance[distance_m]
            assert plane is not None
            assert f"thickness {plane.thickness_deg:.2f}" in axes.get_title("left")


@pytest.mark.parametrize("side", SIDES)
def test_a_covered_eye_ends_elsewhere(
    side: str, traces: NinePositionsTraces, examine: Callable[..., NinePositionsTraces]
) -> None:
    covered = examine(covered=side, distances_m=DISTANCES_M[:1])
    seen, unseen = (t.nine.eyes.activations[0, :, 0] for t in (traces, covered))
    assert (np.abs(seen - unseen).max(axis=1) > 1e-6).all()
    # The eye that sees looks as far off as it is said to.
    eyes, wanted_deg = covered.nine.eyes, covered.nine.wanted_gaze_deg[0]
    i = 1 - SIDES.index(side)
    off_deg = np.linalg.norm(eyes.gaze_deg[0, :, 0, i] - wanted_deg[:, i], axis=-1)
    np.testing.assert_allclose(eyes.missed_deg[0, :, 0], off_deg, rtol=0.05, atol=1e-3)
