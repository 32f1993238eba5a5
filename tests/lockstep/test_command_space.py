import re

import numpy as np
import pytest

from lockstep import ALL_MUSCLES, COMMAND_SPACES, HORIZONTAL_RECTI, PAIR, CommandSpace, InputError
from lockstep.command_space import activation_limits
from lockstep.scales import ScalesConfig
from lockstep.task import TaskConfig

PAIR_OF_RECTI = COMMAND_SPACES[PAIR]


def test_the_pair_commands_both_eyes_left_before_right() -> None:
    assert PAIR_OF_RECTI.names == ("medial_rectus", "lateral_rectus")
    assert PAIR_OF_RECTI.muscle_names == (
        "left_medial_rectus",
        "left_lateral_rectus",
        "right_medial_rectus",
        "right_lateral_rectus",
    )
    assert PAIR_OF_RECTI.indices.tolist() == [0, 1, 6, 7]


def test_muscles_that_share_a_command_are_averaged() -> None:
    values = np.array([0.1, 0.02, 0.3, 0.06])
    assert PAIR_OF_RECTI.from_muscles(values).tolist() == [0.2, 0.04]
    two = PAIR_OF_RECTI.from_muscles(np.stack([values, 2.0 * values]))
    assert two.tolist() == [[0.2, 0.04], [0.4, 0.08]]


def test_a_space_of_single_muscles_keeps_its_own_order() -> None:
    space = CommandSpace(("right_medial_rectus", "left_superior_oblique"))
    assert space.muscle_names == ("left_superior_oblique", "right_medial_rectus")
    assert space.from_muscles(np.array([0.1, 0.2])).tolist() == [0.2, 0.1]
    assert space.from_all(np.arange(12.0)).tolist() == [6.0, 4.0]


def test_one_limit_holds_for_all_commands() -> None:
    limits = activation_limits(PAIR_OF_RECTI, [0.01], [0.2, 0.1])
    assert (limits.lowest, limits.highest) == ((0.01, 0.01), (0.2, 0.1))


@pytest.mark.parametrize(
    ("lowest", "highest", "message"),
    [
        ([0.0] * 3, [0.2], "lowest_activations: expected 2 entries, of medial_rectus, lateral_"),
        ([0.0], [], "highest_activations: expected 2 entries"),
        ([0.0, 0.15], [0.2, 0.1], "expected 0.15 or more for lateral_rectus, the least one, got"),
    ],
)
def test_limits_that_do_not_fit_are_refused(lowest, highest, message) -> None:
    with pytest.raises(InputError, match=re.escape(message)):
        activation_limits(PAIR_OF_RECTI, lowest, highest)


def test_spaces_of_single_muscles_pass_activations_through() -> None:
    values = np.arange(12.0)
    assert COMMAND_SPACES[ALL_MUSCLES].from_all(values).tolist() == values.tolist()
    recti = COMMAND_SPACES[HORIZONTAL_RECTI]
    assert recti.names == PAIR_OF_RECTI.muscle_names
    assert recti.from_all(values).tolist() == [0.0, 1.0, 6.0, 7.0]


def test_spaces_with_lenses_turn_the_eyes_as_those_without() -> None:
    for name, turning in (
        ("pair_and_lens", PAIR),
        ("pair_and_lenses", PAIR),
        ("all_muscles_and_lenses", ALL_MUSCLES),
    ):
        space = COMMAND_SPACES[name]
        assert space.has_lenses
        assert space.turning == COMMAND_SPACES[turning]
        assert space.names[: len(space.turning.names)] == space.turning.names
        config = TaskConfig(
            command_space=name,
            highest_activations=(0.3,),
            lowest_activations=(0,),
            scales=ScalesConfig(n_for_lenses=1),
        )
        assert config.turning_space == turning
        assert config.turning_limits.highest == (0.3,) * len(space.turning.names)
    assert not COMMAND_SPACES[PAIR].has_lenses
    assert COMMAND_SPACES[PAIR].turning is COMMAND_SPACES[PAIR]


def test_one_lens_is_the_mean_of_both_and_two_are_their_own() -> None:
    values = np.arange(16.0)
    assert COMMAND_SPACES["pair_and_lens"].from_all(values).tolist() == [3.0, 4.0, 13.0]
    assert COMMAND_SPACES["pair_and_lenses"].from_all(values).tolist() == [3.0, 4.0, 12.0, 14.0]
    assert len(COMMAND_SPACES["pair_and_lens"].activation_names) == 16
