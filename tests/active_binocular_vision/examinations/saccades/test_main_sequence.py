"""First saccades over time, of eyes that have hardly learned."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from active_binocular_vision import FrozenLearners
from active_binocular_vision.examinations.saccades import main_sequence
from active_binocular_vision.examinations.saccades.main_sequence import MAIN_SEQUENCE, place_deg
from eye_plant.gaze_error import target_place_deg
from lockstep import InputError
from tests.active_binocular_vision.moved_eyes import moved_eyes

FEW: dict[str, Any] = {"amplitudes_deg": (2.0, 10.0), "directions_deg": (0.0, 90.0)}


@pytest.mark.parametrize("direction_deg", [0.0, 45.0, 90.0, 180.0, 225.0])
def test_a_place_is_as_far_and_where_it_should_be(direction_deg: float) -> None:
    seen_deg = target_place_deg(np.eye(3), *place_deg(20.0, direction_deg).tolist())
    direction = np.radians(direction_deg)
    expected_deg = 20.0 * np.array([np.cos(direction), np.sin(direction)])
    np.testing.assert_allclose(seen_deg, expected_deg, atol=1e-9)


@pytest.mark.parametrize("duration_s", [2.0, 0.2])
def test_a_saccade_follows_its_command_and_creeps_after_the_period_of_400_ms(
    gazing_run: Path, monkeypatch: pytest.MonkeyPatch, duration_s: float
) -> None:
    monkeypatch.setattr(main_sequence, "_DURATION_S", duration_s)
    left_medial = np.eye(12)[0]
    with moved_eyes(lambda _, target_deg: 0.004 * target_deg[0] * left_medial):
        found = MAIN_SEQUENCE(FrozenLearners(gazing_run), **FEW)
    (small, _), _, (large, movement), (upward, _) = found.traces.saccades
    forward, left, _ = movement.sight[-1]
    assert forward > 0.0 > left
    assert large.amplitude_deg > 3.0 * small.amplitude_deg
    # A period longer than what is simulated has it all.
    expected = (0.3, 0.99) if duration_s > 0.4 else (1.0, 1.0)
    assert expected[0] <= large.share_in_period <= expected[1]
    # These eyes do not move up, so they miss by the whole distance.
    assert upward.amplitude_deg < 0.01
    assert upward.missed_deg == pytest.approx(10.0, abs=0.05)
    ratio_per_s = large.peak_velocity_deg_s / large.amplitude_deg
    assert found.summary.slope_per_s == pytest.approx(ratio_per_s, rel=0.1)


def test_eyes_that_have_not_learned_to_move_are_refused(gazing_run: Path) -> None:
    with (
        moved_eyes(lambda *_: np.zeros(12)),
        pytest.raises(InputError, match="expected learners that have learned saccades"),
    ):
        MAIN_SEQUENCE(FrozenLearners(gazing_run), **FEW)
