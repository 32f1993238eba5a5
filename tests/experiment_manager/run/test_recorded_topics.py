"""Each topic is recorded in one way."""

from experiment_manager.run.recorded_topics import (
    FREE_TOPICS,
    OWN_TOPICS,
    SAMPLED_TOPICS,
    SMALL_TOPICS_OF_HEADS,
    SMALL_TOPICS_WITH_GAZE,
    recorded_types,
)
from lockstep import COMMAND_SPACES
from lockstep.wire.topics import GAZE, TOPIC_TYPES


def test_each_topic_is_recorded_in_one_way() -> None:
    others = (*FREE_TOPICS, *OWN_TOPICS, *SAMPLED_TOPICS)
    for space, small in (
        ("all_muscles", SMALL_TOPICS_WITH_GAZE),
        ("vergence", SMALL_TOPICS_OF_HEADS),
    ):
        found = recorded_types(COMMAND_SPACES[space])
        assert {*small, *others, GAZE} == set(found)
        assert found.items() < TOPIC_TYPES.items()
    assert set(SAMPLED_TOPICS) == {
        "left/image_raw",
        "right/image_raw",
        "left/camera_info",
        "right/camera_info",
        "features",
    }
