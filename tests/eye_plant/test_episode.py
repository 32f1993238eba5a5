import dataclasses

import pytest

from eye_plant import Episode
from lockstep import InputError
from tests.eye_plant.plant_bench import EPISODE as AN_EPISODE

EPISODE = dataclasses.replace(AN_EPISODE, n_iterations=6)
WITH_TARGETS = dataclasses.replace(EPISODE, targets_deg=(1.0, 2.0, 3.0, 4.0))


def test_each_target_holds_for_an_equal_part_and_the_last_one_to_the_end() -> None:
    found = [WITH_TARGETS.target_deg(i) for i in range(7)]
    assert found == [(1.0, 2.0)] * 3 + [(3.0, 4.0)] * 4
    begins = [WITH_TARGETS.begins_fixation(i) for i in range(6)]
    assert begins == [True, False, False, True, False, False]
    longer = dataclasses.replace(WITH_TARGETS, n_iterations=7)
    assert [longer.begins_fixation(i) for i in range(7)] == [*begins, False]


def test_without_targets_there_is_no_fixation() -> None:
    assert EPISODE.target_deg(0) is None
    assert not EPISODE.begins_fixation(0)


@pytest.mark.parametrize("episode", [EPISODE, WITH_TARGETS])
def test_a_request_brings_the_episode(episode: Episode) -> None:
    arguments = episode.as_arguments()
    assert ("targets_deg" in arguments) == bool(episode.targets_deg)
    as_lists = {n: list(v) if isinstance(v, tuple) else v for n, v in arguments.items()}
    assert Episode.from_arguments(as_lists) == episode


@pytest.mark.parametrize("targets_deg", [(1.0,), (1.0, 2.0, 3.0), (1.0, 2.0) * 7])
def test_targets_that_do_not_share_the_episode_are_refused(targets_deg) -> None:
    n = len(targets_deg)
    with pytest.raises(InputError, match=f"elevation of 6 targets or less, got {n} numbers"):
        dataclasses.replace(EPISODE, targets_deg=targets_deg)
