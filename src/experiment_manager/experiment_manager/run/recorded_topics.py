"""Which topics are recorded: of each observation, whenever they come, or of a sample. No ROS."""

from experiment_manager.config import ExperimentManagerConfig
from lockstep import CommandSpace
from lockstep.wire.topics import (
    CODER_VECTORS,
    GAZE,
    HEAD_VECTORS,
    JOINT_COMMAND,
    LEARNER_VECTORS,
    PARAMETER_CHANGES,
    PLANT_VECTORS,
    TOPIC_TYPES,
)

# Always recorded, exactly one of each per observation ...
SMALL_TOPICS = (*PLANT_VECTORS, *CODER_VECTORS, *LEARNER_VECTORS)
# ... of eyes that make saccades one more ...
SMALL_TOPICS_WITH_GAZE = (*SMALL_TOPICS, GAZE)
# ... of a robot's head other ones ...
SMALL_TOPICS_OF_HEADS = (*HEAD_VECTORS, *CODER_VECTORS, JOINT_COMMAND, "actor_critic")
# ... recorded whenever they come ...
FREE_TOPICS = ("/clock", "/diagnostics")
# ... written by the recorder itself ...
OWN_TOPICS = (PARAMETER_CHANGES,)
# ... and recorded for a sample of the episodes, since they are large.
SAMPLED_TOPICS = tuple(
    name
    for name in TOPIC_TYPES
    if name not in (*SMALL_TOPICS_WITH_GAZE, *SMALL_TOPICS_OF_HEADS, *FREE_TOPICS, *OWN_TOPICS)
)


def small_topics(config: ExperimentManagerConfig) -> tuple[str, ...]:
    """Return the topics of which each observation of a run has one message."""
    if config.space.of_joints:
        return SMALL_TOPICS_OF_HEADS
    return SMALL_TOPICS_WITH_GAZE if config.learns_turns else SMALL_TOPICS


def recorded_types(space: CommandSpace) -> dict[str, str]:
    """Return the type of each topic that a bag of a command space may hold."""
    of_eyes, of_heads = set(SMALL_TOPICS), set(SMALL_TOPICS_OF_HEADS)
    absent = of_eyes - of_heads if space.of_joints else of_heads - of_eyes
    return {topic: kind for topic, kind in TOPIC_TYPES.items() if topic not in absent}
