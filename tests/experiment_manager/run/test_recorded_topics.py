"""Each topic is recorded in one way."""

from experiment_manager.run.recorded_topics import (
    FREE_TOPICS,
    OWN_TOPICS,
    SAMPLED_TOPICS,
    SMALL_TOPICS_WITH_GAZE,
)
from lockstep.wire.topics import TOPIC_TYPES


def test_each_topic_is_recorded_in_one_way() -> None:
    assert sorted((*SMALL_TOPICS_WITH_GAZE, *FREE_TOPICS, *OWN_TOPICS, *SAMPLED_TOPICS)) == sorted(
        TOPIC_TYPES
    )
    assert set(SAMPLED_TOPICS) == {
        "left/image_raw",
        "right/image_raw",
        "left/camera_info",
        "right/camera_info",
        "features",
    }
