"""The topics of the graph: their types and the names in their vectors. This table is the wiring.

Names are relative to the namespace of the nodes, unless they start with "/".
"""

from collections.abc import Sequence

from lockstep.command_space import SIDES, CommandSpace
from lockstep.scales import SCALES, ScalesConfig

TRAINING, TEST = 0, 1

EPISODE_NAMES = (
    "phase",
    "test",
    "trial",
    "episode",
    "iteration",
    "training_iteration",
    "observation",
)
# A gaze target in the left picture, or in that of the eye that is to look there.
TARGET_NAMES = ("target_sideways_deg", "target_up_deg")
# Of eyes that make saccades: the target in either picture when a fixation begins.
RIGHT_TARGET_NAMES = tuple(f"right_{name}" for name in TARGET_NAMES)
GIVEN_TARGET_NAMES = (*TARGET_NAMES, *RIGHT_TARGET_NAMES)
GROUND_TRUTH_NAMES = (
    *EPISODE_NAMES,
    "stimulus",
    "object_distance_m",
    "vergence_deg",
    "desired_vergence_deg",
    "vergence_error_deg",
    "vertical_error_deg",
    "cyclovergence_error_deg",
    "version_deg",
    "elevation_deg",
    "left_torsion_deg",
    "right_torsion_deg",
    "left_deviation_deg",
    "right_deviation_deg",
    "metabolic_rate_w",
    "initial_metabolic_rate_w",
    "optimal_metabolic_rate_w",
    *GIVEN_TARGET_NAMES,
)
EYE_STATE_NAMES = tuple(
    f"{side}_{angle}" for side in SIDES for angle in ("adduction", "elevation", "torsion")
)
# A fixation begins with so many saccades: one to the target, one to what is left.
N_SACCADES = 2
# What they need: the target in the picture of the eye that leads, how both eyes turned since the
# observation before, and which eye leads: 0 the left one, 1 the right one.
GAZE_NAMES = (
    *TARGET_NAMES,
    *(f"{side}_{turn}_deg" for side in SIDES for turn in ("sideways", "up", "clockwise")),
    "leading_eye",
)


def eye_state_names(space: CommandSpace) -> tuple[str, ...]:
    """Return the names of the topic eye_states: of eyes with lenses these, too."""
    of_lenses = ("accommodation_d", "focus_d", "pupil_m") if space.has_lenses else ()
    return EYE_STATE_NAMES + tuple(f"{side}_{name}" for side in SIDES for name in of_lenses)


def apart_pictures(scales: ScalesConfig) -> tuple[str, ...]:
    """Return the topics of the pictures that scales have apart, left before right."""
    return tuple(f"{side}/{scale.name}/image_raw" for scale in scales.apart for side in SIDES)


def reward_names(scales: Sequence[str] = SCALES) -> tuple[str, ...]:
    """Return the names of the topic reward, with an error for each scale."""
    return (
        *(f"reconstruction_error_{scale}" for scale in scales),
        "metabolic_rate_w",
        "energy_penalty",
        "reward",
        "learning_steps",
    )


def unsure_truth_names(space: CommandSpace) -> tuple[str, ...]:
    """Return the names of ground truth that are NaN where nobody knows them."""
    if space.of_joints:
        return GROUND_TRUTH_NAMES[len(EPISODE_NAMES) + 1 :]  # all but the stimulus
    return ("optimal_metabolic_rate_w",)


def unsure_reward_names(space: CommandSpace) -> tuple[str, ...]:
    """Return the names of the reward that are NaN where there are no muscles."""
    return ("metabolic_rate_w",) if space.of_joints else ()


def actor_critic_names(space: CommandSpace) -> tuple[str, ...]:
    """Return the names of the topic actor_critic, with an action for each command."""
    return (
        "value",
        "td_error",
        "td_variance",
        "actor_learning_rate",
        "critic_learning_rate",
        *(f"{name}_action" for name in space.names),
        "learning_steps",
    )


VECTOR = "sensor_msgs/msg/JointState"
IMAGE = "sensor_msgs/msg/Image"
CAMERA_INFO = "sensor_msgs/msg/CameraInfo"

# One message of each per observation, the last of an episode included ...
PLANT_VECTORS = ("episode", "muscle_states", "muscle_activations", "eye_states", "ground_truth")
# ... or of a robot's head, whose states are sent last ...
JOINT_STATES, JOINT_COMMAND = "joint_states", "joint_command"
HEAD_VECTORS = ("episode", "ground_truth", JOINT_STATES)
# ... and these only for the observations that are answered.
CODER_VECTORS = ("reward",)
MUSCLE_COMMAND = "muscle_command"
LEARNER_VECTORS = (MUSCLE_COMMAND, "actor_critic")
# ... and, by the coder, only where vergence is learned as turns.
GAZE = "gaze"
PICTURES = ("left/image_raw", "right/image_raw")
CAMERA_INFOS = ("left/camera_info", "right/camera_info")
# One message per change of the plant in the course of a run: its own names each time.
PARAMETER_CHANGES = "parameter_changes"

TOPIC_TYPES = {
    **dict.fromkeys(PICTURES, IMAGE),
    **dict.fromkeys(CAMERA_INFOS, CAMERA_INFO),
    **dict.fromkeys(PLANT_VECTORS, VECTOR),
    "features": IMAGE,
    **dict.fromkeys(CODER_VECTORS, VECTOR),
    GAZE: VECTOR,
    **dict.fromkeys(LEARNER_VECTORS, VECTOR),
    **dict.fromkeys((JOINT_STATES, JOINT_COMMAND), VECTOR),
    PARAMETER_CHANGES: VECTOR,
    "/clock": "rosgraph_msgs/msg/Clock",
    "/diagnostics": "diagnostic_msgs/msg/DiagnosticArray",
}

# For people to look at, an IMAGE and a VECTOR: no part of the protocol, and not recorded.
BASIS_FUNCTIONS = "basis_functions"
MEAN_METABOLIC_RATES = "mean_metabolic_rates"
# From people and other programs, a VECTOR: where the eyes are to look next, with TARGET_NAMES.
GAZE_TARGET = "gaze_target"


def state_topic(space: CommandSpace) -> str:
    """Return the topic with the state of what is commanded."""
    return JOINT_STATES if space.of_joints else "muscle_activations"


def command_topic(space: CommandSpace) -> str:
    """Return the topic of commands."""
    return JOINT_COMMAND if space.of_joints else MUSCLE_COMMAND
