"""What trials a bag holds."""

import numpy as np
import pytest

from active_binocular_vision.runs.recorded import trial_table
from experiment_manager.bag.reader import VectorTable
from lockstep import COMMAND_SPACES, PAIR, InputError
from lockstep.wire.topics import GROUND_TRUTH_NAMES

NONE = np.zeros((2, 0))


def _truth(names: tuple[str, ...]) -> VectorTable:
    position = np.arange(2.0 * len(names)).reshape(2, -1)
    return VectorTable(names, np.arange(2), position, NONE, NONE)


def test_an_older_bag_does_not_have_where_the_right_eye_saw_targets() -> None:
    table = trial_table(_truth(GROUND_TRUTH_NAMES[:-2]), None, COMMAND_SPACES[PAIR])
    np.testing.assert_array_equal(table.column("right_target_up_deg"), [np.nan, np.nan])
    assert np.isfinite(table.column("target_up_deg")).all()


def test_other_ground_truth_is_not_missed_in_silence() -> None:
    with pytest.raises(InputError, match=r"expected one of .*, got 'phase'"):
        trial_table(_truth(GROUND_TRUTH_NAMES[1:]), None, COMMAND_SPACES[PAIR])
