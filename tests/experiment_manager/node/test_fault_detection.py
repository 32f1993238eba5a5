"""What silence of the graph ends a run, what is waited for, and which learning steps are due."""

import dataclasses

import pytest

from experiment_manager.node.fault_detection import (
    Fault,
    Wait,
    check_learning_steps,
    of_silence,
)
from experiment_manager.run.episode_record import EpisodeRecord
from eye_plant import Episode
from lockstep import InputError
from lockstep.wire.topics import TEST, TRAINING
from tests.pair import pair_activations

PERIOD_NS = 200_000_000


def _record(phase: int) -> EpisodeRecord:
    """Return the fourth training episode of 10 iterations, or a trial just before it."""
    episode = dataclasses.replace(
        Episode.alone(0, 1.0, pair_activations(0.0, 0.0), n_iterations=10),
        phase=phase,
        episode=3,
        training_iteration=30,
        first_observation=100,
    )
    return EpisodeRecord(episode, PERIOD_NS)


@pytest.mark.parametrize(
    ("absent", "silent_s", "supervised", "found"),
    [
        ([], 6.0, True, Fault("no message for 5 s; missing: 2 of reward")),
        ([], 600.0, False, Wait("no message for 5 s; missing: 2 of reward")),
        (["reward"], 60.0, True, Wait("waiting for reward")),
        (["reward"], 61.0, True, Fault("no publisher of reward for 61 s")),
        (["reward", "actor_critic"], 600.0, False, Wait("waiting for reward, actor_critic")),
    ],
)
def test_silence_is_a_fault_only_of_a_supervised_node_that_is_there_or_long_lost(
    absent, silent_s, supervised, found
) -> None:
    assert of_silence(5.0, "2 of reward", absent, silent_s, supervised=supervised) == found


def test_a_gap_that_is_long_makes_a_lost_node_wait_longer() -> None:
    found = of_silence(40.0, "2 of reward", ["reward"], 79.0, supervised=True)
    assert found == Wait("waiting for reward")


@pytest.mark.parametrize(
    ("topic", "phase", "iteration", "expected"),
    [
        ("reward", TRAINING, 4, 34),  # one step per iteration, after the answer
        ("actor_critic", TRAINING, 4, 31),  # none in the first iteration of 4 episodes
        ("reward", TEST, 4, 30),
        ("actor_critic", TEST, 4, 27),
    ],
)
def test_learning_steps_must_be_those_of_the_protocol(topic, phase, iteration, expected) -> None:
    stamp_ns = (100 + iteration) * PERIOD_NS
    check_learning_steps(topic, _record(phase), stamp_ns, float(expected))
    for found in (expected - 1, expected + 1):
        message = f"expected {expected} learning steps in episode 3, got {found}"
        with pytest.raises(InputError, match=message):
            check_learning_steps(topic, _record(phase), stamp_ns, float(found))
