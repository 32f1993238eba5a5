"""Which antagonists are silent, by hand."""

import numpy as np
import pytest

from active_binocular_vision.examinations.positions.measures import silences

MEDIAL, LATERAL, LEFT_IO = 0, 1, 5
HORIZONTAL = "left_medial_rectus-left_lateral_rectus"
OBLIQUES = "left_superior_oblique-left_inferior_oblique"


def test_silent_antagonists_by_hand() -> None:
    optimum, eyes = np.zeros((2, 12), bool), np.zeros((2, 3, 12), bool)
    optimum[0, MEDIAL] = optimum[1, [MEDIAL, LATERAL]] = True
    # At the first gaze the right muscle, the wrong one and none; at the second the medial rectus.
    eyes[0, 0, MEDIAL] = eyes[0, 1, LATERAL] = eyes[1, 2, MEDIAL] = True
    eyes[0, :, LEFT_IO] = True
    found = silences(eyes, optimum)
    assert len(found) == 7
    horizontal = found[HORIZONTAL]
    assert horizontal.share_silent == pytest.approx(3 / 6)
    assert horizontal.share_silent_in_optimum == 1.0
    assert horizontal.n_silent_in_optimum == 3
    # Three muscles before three pictures, of which two are silent.
    assert horizontal.share_optimally_silent == pytest.approx(2 / 9)
    assert found[OBLIQUES].share_silent == pytest.approx(3 / 6)
    assert found[OBLIQUES].share_silent_in_optimum == 0.0
    assert found[OBLIQUES].share_optimally_silent is None
    everything = found["all"]
    assert everything.share_silent == pytest.approx(6 / 36)
    assert everything.share_silent_in_optimum == pytest.approx(2 / 12)
    assert everything.share_optimally_silent == pytest.approx(2 / 9)
