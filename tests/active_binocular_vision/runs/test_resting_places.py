"""Where trials come to rest, by hand."""

import numpy as np
import pytest

from active_binocular_vision.runs.resting_places import resting_places
from experiment_manager import Trials
from tests.pair import PAIR_SPACE


def _trials(errors_deg: list[list[float]], pairs: list[tuple[int, float]]) -> Trials:
    error_deg = np.array(errors_deg)
    stimulus, distance_m = np.array(pairs, dtype=np.float64).T
    columns = {
        "stimulus": np.broadcast_to(stimulus[:, None], error_deg.shape),
        "object_distance_m": np.broadcast_to(distance_m[:, None], error_deg.shape),
        "vergence_error_deg": error_deg,
    }
    return Trials(
        PAIR_SPACE, 0, np.arange(len(error_deg)), columns, np.zeros(error_deg.shape, dtype=int)
    )


def test_resting_places_by_hand() -> None:
    # Of four iterations the last two count as rest.
    rest = resting_places(
        _trials(
            [
                [2.0, 0.3, 0.2, 0.1, 0.1],  # rests at 0.1; 0.2 off, then 0.1
                [-2.0, 0.1, 0.3, 0.3, 0.3],  # rests at 0.3; 0.2 off, then 0
                [-0.2, -0.2, -0.2, -0.2, -0.2],  # rests at -0.2, from the start
                [1.0, 1.0, 1.0, -0.4, -0.2],  # rests at -0.3, restless; from too far off
                [2.0, 2.0, 2.0, 2.0, 2.0],  # has not arrived
            ],
            [(7, 1.0), (7, 1.0), (7, 2.0), (7, 2.0), (8, 1.0)],
        )
    )
    assert rest.n_trials == 4
    assert rest.bias_deg == pytest.approx(-0.05)
    assert rest.spread_deg == pytest.approx(np.std([0.1, 0.3, -0.2, -0.3]))
    assert rest.within_deg == pytest.approx((0.1 + 0.05) / 2)
    assert rest.between_deg == pytest.approx(0.225)
    assert rest.restlessness_deg == pytest.approx(0.0)
    assert rest.share_left == pytest.approx((0.2 * 0.1) / (0.2**2 + 0.2**2))


def test_where_nothing_tells_there_is_no_number() -> None:
    nobody = resting_places(_trials([[3.0, 3.0, 3.0, 3.0]], [(0, 1.0)]))
    assert (nobody.n_trials, nobody.bias_deg, nobody.share_left) == (0, None, None)
    # One iteration, and one trial of its kind: neither an approach nor a spread among equals.
    alone = resting_places(_trials([[0.5, 0.2]], [(0, 1.0)]))
    assert (alone.n_trials, alone.bias_deg) == (1, pytest.approx(0.2))
    assert (alone.within_deg, alone.between_deg) == (None, None)
    assert alone.share_left is None
