"""Which topics are recorded: of each observation, whenever they come, or of a sample. No ROS."""

from experiment_manager.config import ExperimentManagerConfig
from lockstep.wire.topics import (
    CODER_VECTORS,
    GAZE,
    LEARNER_VECTORS,
    PARAMETER_CHANGES,
    PLANT_VECTORS,
    TOPIC_TYPES,
)

# Always recorded, exactly one of each per observation ...
SMALL_TOPICS = (*PLANT_VECTORS, *CODER_VECTORS, *LEARNER_VECTORS)
# ... of eyes that make saccades one more ...
SMALL_TOPICS_WITH_GAZE = (*SMALL_TOPICS, GAZE)
# ... recorded whenever they come ...
FREE_TOPICS = ("/clock", "/diagnostics")
# ... written by the recorder itself ...
OWN_TOPICS = (PARAMETER_CHANGES,)
# ... and recorded for a sample of the episodes, since they are large.
SAMPLED_TOPICS = tuple(
    name for name in TOPIC_TYPES if name not in (*SMALL_TOPICS_WITH_GAZE, *FREE_TOPICS, *OWN_TOPICS)
)


def small_topics(config: ExperimentManagerConfig) -> tuple[str, ...]:
    """Return the topics of which each observation of a run has one message."""
    return SMALL_TOPICS_WITH_GAZE if config.learns_turns else SMALL_TOPICS
