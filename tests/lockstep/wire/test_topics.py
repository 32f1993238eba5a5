"""What the table of topics must be, whatever its names; docs/interfaces.md has them all."""

from lockstep.wire import topics
from tests.pair import ACTOR_CRITIC_NAMES, COMMAND_NAMES


def test_an_episode_says_nothing_of_distance_or_gaze() -> None:
    known = {*COMMAND_NAMES, *ACTOR_CRITIC_NAMES}
    truth = topics.GROUND_TRUTH_NAMES[len(topics.EPISODE_NAMES) :]
    assert topics.EPISODE_NAMES + truth == topics.GROUND_TRUTH_NAMES
    assert {"object_distance_m", "vergence_error_deg"} < set(truth)
    assert not set(truth) & {*topics.EPISODE_NAMES, *known}
    assert not any(name.endswith(("_m", "_deg", "_w")) for name in topics.EPISODE_NAMES)


def test_each_vector_has_one_publisher() -> None:
    learning = (*topics.PLANT_VECTORS, *topics.CODER_VECTORS, *topics.LEARNER_VECTORS)
    vectors = [name for name, kind in topics.TOPIC_TYPES.items() if kind == topics.VECTOR]
    assert sorted((*learning, topics.GAZE, topics.PARAMETER_CHANGES)) == sorted(vectors)
