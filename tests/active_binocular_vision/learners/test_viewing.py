"""Eyes go on from where they came to."""

from pathlib import Path

import numpy as np
import pytest

from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.shown import OWN_TEST_STIMULI
from active_binocular_vision.learners.viewing import Viewing
from lockstep import InputError


@pytest.fixture
def learners(small_run: Path) -> FrozenLearners:
    return FrozenLearners(small_run)


# Both medial recti are active.
_FIRST = [0.05, *[0.0] * 5] * 2


def test_two_parts_are_as_one(learners: FrozenLearners) -> None:
    stimuli = OWN_TEST_STIMULI.load(learners.plant.stimuli, 2)
    with learners.loop(stimuli) as loop:
        whole = Viewing(loop, 1, 1.0, _FIRST).look(4)
        parted = Viewing(loop, 1, 1.0, _FIRST)
        parts = [*parted.look(1)[:-1], *parted.look(3)]
    angles = (
        [np.array(o.state.activations) for o in whole],
        [np.array(o.state.activations) for o in parts],
    )
    np.testing.assert_array_equal(*angles)
    assert any((a != angles[0][0]).any() for a in angles[0])


def test_a_part_has_settings_of_its_own(learners: FrozenLearners) -> None:
    stimuli = OWN_TEST_STIMULI.load(learners.plant.stimuli, 2)
    with learners.loop(stimuli) as loop:
        viewing = Viewing(loop, 0, 1.0, _FIRST)
        viewing.look(1, {"camera.left_occluded": True})
        assert loop.plant.config.camera.left_occluded
        with pytest.raises(InputError, match=r"camera\.no_such"):
            viewing.look(1, {"camera.no_such": 1})
        viewing.look(1)
        assert not loop.plant.config.camera.left_occluded
