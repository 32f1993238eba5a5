"""The table of topics as it was agreed on: whoever changes it here changes every user's wiring."""

from rclpy.qos import HistoryPolicy, ReliabilityPolicy

from lockstep.wire import topics
from lockstep.wire.qos import LOCKSTEP_QOS, QUEUE_DEPTH

TABLE = {
    "left/image_raw": "sensor_msgs/msg/Image",
    "right/image_raw": "sensor_msgs/msg/Image",
    "left/camera_info": "sensor_msgs/msg/CameraInfo",
    "right/camera_info": "sensor_msgs/msg/CameraInfo",
    "episode": "sensor_msgs/msg/JointState",
    "muscle_states": "sensor_msgs/msg/JointState",
    "muscle_activations": "sensor_msgs/msg/JointState",
    "eye_states": "sensor_msgs/msg/JointState",
    "ground_truth": "sensor_msgs/msg/JointState",
    "features": "sensor_msgs/msg/Image",
    "reward": "sensor_msgs/msg/JointState",
    "muscle_command": "sensor_msgs/msg/JointState",
    "actor_critic": "sensor_msgs/msg/JointState",
    "parameter_changes": "sensor_msgs/msg/JointState",
    "/clock": "rosgraph_msgs/msg/Clock",
    "/diagnostics": "diagnostic_msgs/msg/DiagnosticArray",
}
TRUTH_ALONE = {
    "stimulus",
    "object_distance_m",
    "vergence_deg",
    "desired_vergence_deg",
    "vergence_error_deg",
    "version_deg",
    "left_deviation_deg",
    "right_deviation_deg",
    "metabolic_rate_w",
    "initial_metabolic_rate_w",
    "optimal_metabolic_rate_w",
}


def test_topics_and_types() -> None:
    assert topics.TOPIC_TYPES == TABLE


def test_episode_says_nothing_of_distance_or_gaze() -> None:
    assert set(topics.EPISODE_NAMES) == {
        "phase",
        "test",
        "trial",
        "episode",
        "iteration",
        "training_iteration",
        "observation",
    }


def test_ground_truth_is_the_names_of_episode_and_its_own() -> None:
    n_shared = len(topics.EPISODE_NAMES)
    assert topics.GROUND_TRUTH_NAMES[:n_shared] == topics.EPISODE_NAMES
    assert set(topics.GROUND_TRUTH_NAMES[n_shared:]) == TRUTH_ALONE


def test_each_vector_of_the_table_has_one_publisher() -> None:
    learning = (*topics.PLANT_VECTORS, *topics.CODER_VECTORS, *topics.LEARNER_VECTORS)
    vectors = (*learning, "parameter_changes")
    assert sorted(vectors) == sorted(k for k, v in TABLE.items() if v.endswith("JointState"))


def test_quality_of_service_is_reliable_and_holds_more_than_a_trial() -> None:
    assert LOCKSTEP_QOS.reliability == ReliabilityPolicy.RELIABLE
    assert LOCKSTEP_QOS.history == HistoryPolicy.KEEP_LAST
    # A trial is 21 observations, and a waiting plant repeats one of them each second.
    assert LOCKSTEP_QOS.depth == QUEUE_DEPTH >= 2 * 21
