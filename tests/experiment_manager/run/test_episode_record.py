"""An episode is over when each of its messages has been recorded, and not before."""

import dataclasses

import pytest

from experiment_manager.run.episode_record import EpisodeRecord
from eye_plant import Episode
from tests.pair import pair_activations

PERIOD_NS = 100_000_000
PLANT = ("episode", "muscle_states", "muscle_activations", "eye_states", "ground_truth")
ANSWERS = ("reward", "muscle_command", "actor_critic")


EPISODE = dataclasses.replace(
    Episode.alone(0, 1.0, pair_activations(0.1, 0.0), n_iterations=2), first_observation=40
)


@pytest.mark.parametrize(
    ("observation", "offset_ns", "expected"),
    [
        (39, 0, False),
        (40, 0, True),
        (41, 0, True),
        (42, 0, True),
        (43, 0, False),
        (41, 1, False),
        (40, -1, False),
    ],
)
def test_stamps_of_the_episode(observation: int, offset_ns: int, expected: bool) -> None:
    record = EpisodeRecord(EPISODE, PERIOD_NS)
    assert record.holds(observation * PERIOD_NS + offset_ns) is expected


def test_complete_with_the_very_last_message() -> None:
    record = EpisodeRecord(EPISODE, PERIOD_NS)
    expected = [topic for topic in PLANT for _ in range(3)]
    expected += [topic for topic in ANSWERS for _ in range(2)]
    for topic in expected:
        assert not record.is_complete
        record.count(topic)
    assert record.is_complete
    assert record.missing() == ""


def test_nobody_is_to_answer_the_last_observation() -> None:
    record = EpisodeRecord(EPISODE, PERIOD_NS)
    for topic in PLANT:
        assert record.expects(topic, 42 * PERIOD_NS)
    for topic in ANSWERS:
        assert record.expects(topic, 41 * PERIOD_NS)
        assert not record.expects(topic, 42 * PERIOD_NS)


def test_one_message_too_many_does_not_stand_for_a_missing_one() -> None:
    record = EpisodeRecord(EPISODE, PERIOD_NS)
    for topic in (*[t for t in PLANT for _ in range(3)], *[t for t in ANSWERS for _ in range(2)]):
        record.count("reward" if topic == "eye_states" else topic)
    assert not record.is_complete


def test_missing_messages_are_named() -> None:
    record = EpisodeRecord(EPISODE, PERIOD_NS)
    for topic in PLANT:
        for _ in range(3):
            record.count(topic)
    record.count("reward")
    assert record.missing() == "1 of reward, 2 of muscle_command, 2 of actor_critic"
