"""What the agent takes from messages, and what it puts into its own."""

from typing import Any

import numpy as np
from sensor_msgs.msg import Image, JointState

from lockstep import SIDES, CommandSpace, InputError
from lockstep.wire.topics import GAZE, GAZE_NAMES, state_topic
from lockstep.wire.vectors import values_of
from vergence_rl.learning_rule import Decision


def features_of(message: Image, n_scales: int) -> np.ndarray:
    """Return the features (n_scales, n_bases) float32 of a 32FC1 message, without a copy.

    Raises InputError for another encoding, another number of rows, data that does not match the
    stated size, and values that are not finite.
    """
    height, width = message.height, message.width
    if (
        message.encoding != "32FC1"
        or message.is_bigendian
        or height != n_scales
        or len(message.data) != 4 * width * height
    ):
        raise InputError(
            f"features: expected little-endian 32FC1 with {n_scales} rows and 4 bytes an entry, "
            f"got {message.encoding!r}, {height} x {width}, {len(message.data)} bytes"
        )
    features = np.frombuffer(message.data, dtype=np.float32).reshape(height, width)
    if not np.isfinite(features).all():
        raise InputError("features: expected finite values, got NaN or infinity")
    return features


def activations_of(message: JointState, space: CommandSpace) -> np.ndarray:
    """Return the activations (n_names,) that commands of the space set, as they are felt.

    Of joints these are angles in rad. Where activations are felt with noise, the message has them
    as velocity. Raises InputError as `values_of`, and for an activation out of [0, 1].
    """
    is_felt = len(message.velocity) and not space.of_joints
    field = "velocity" if is_felt else "position"
    values = values_of(message, space.muscle_names, state_topic(space), field)
    if not space.of_joints and not ((values >= 0.0) & (values <= 1.0)).all():
        raise InputError(
            f"muscle_activations: expected activations in [0, 1], got {values.tolist()}"
        )
    return space.from_muscles(values)


def gaze_of(message: JointState, reward: JointState) -> dict[str, Any]:
    """Return what Agent.observe takes beside what it takes of all eyes, by its names there.

    Raises InputError as `values_of`; NaN stands for what there is not.
    """
    values = values_of(message, GAZE_NAMES, GAZE, may_lack=GAZE_NAMES[:-1])
    (energy_penalty,) = values_of(reward, ("energy_penalty",), "reward").tolist()
    return {
        "target_deg": values[:2],
        "turns_deg": values[2:-1].reshape(len(SIDES), -1),
        "leading_eye": float(values[-1]),
        "energy_penalty": energy_penalty,
    }


def actor_critic_values(decision: Decision, learning_steps: int) -> tuple[float, ...]:
    """Return the values of lockstep.wire.topics.actor_critic_names."""
    return (
        decision.value,
        decision.td_error,
        decision.td_variance,
        decision.actor_learning_rate,
        decision.critic_learning_rate,
        *decision.action,
        learning_steps,
    )
