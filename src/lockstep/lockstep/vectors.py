"""Stamped vectors of named doubles, carried by sensor_msgs/JointState.

JointState is the one standard message that names its numbers, and every plotting tool reads it.
"""

import array
from collections.abc import Sequence

import numpy as np
from rclpy.node import Node
from rclpy.publisher import Publisher
from sensor_msgs.msg import JointState

from lockstep.errors import InputError
from lockstep.qos import LOCKSTEP_QOS
from lockstep.stamped_bytes import StampedBytes
from lockstep.stamps import to_time

# Up to here every whole number is a double of its own.
_MAX_WHOLE = 2.0**53
_FIRST_PLACE = np.uint64(0x7FF4_0000_0000_0000)

Vector = np.ndarray | Sequence[float]


def _doubles(values: Vector) -> array.array:
    return array.array("d", np.asarray(values, dtype=np.float64).tobytes())


def vector_message(
    stamp_ns: int,
    names: Sequence[str],
    position: Vector,
    velocity: Vector = (),
    effort: Vector = (),
) -> JointState:
    """Return the message of named values; position, velocity, effort: (n_names,) or empty."""
    message = JointState()
    message.header.stamp = to_time(stamp_ns)
    message.name = list(names)
    # The setters accept arrays of doubles without looking at each entry.
    message.position = _doubles(position)
    message.velocity = _doubles(velocity)
    message.effort = _doubles(effort)
    return message


class VectorPublisher:
    """Publishes vectors with fixed names on one topic, and can repeat the last one."""

    def __init__(self, node: Node, topic: str, names: Sequence[str]) -> None:
        """names: the entries of each vector, in order."""
        self.publisher: Publisher = node.create_publisher(JointState, topic, LOCKSTEP_QOS)
        self._names = tuple(names)
        self._layouts: dict[tuple[bool, bool], StampedBytes] = {}
        self._last = b""

    def publish(
        self, stamp_ns: int, position: Vector, velocity: Vector = (), effort: Vector = ()
    ) -> None:
        """Publish (n_names,) values; velocity and effort may be empty."""
        has_velocity, has_effort = len(velocity) > 0, len(effort) > 0
        layout = self._layouts.get((has_velocity, has_effort))
        if layout is None:
            layout = _layout(self._names, has_velocity, has_effort)
            self._layouts[has_velocity, has_effort] = layout
        values = [position]
        if has_velocity:
            values.append(velocity)
        if has_effort:
            values.append(effort)
        self._last = layout.fill(stamp_ns, *values)
        self.publisher.publish(self._last)

    def repeat(self) -> None:
        """Publish the last vector again, if there was one."""
        if self._last:
            self.publisher.publish(self._last)


def _layout(names: Sequence[str], has_velocity: bool, has_effort: bool) -> StampedBytes:
    # Numbers that are no numbers, each another: no name and no length looks like them.
    places = (np.arange(3 * len(names), dtype=np.uint64) + _FIRST_PLACE).view(np.float64)
    fields = [
        place if is_there else np.zeros(0)
        for place, is_there in zip(
            places.reshape(3, -1), (True, has_velocity, has_effort), strict=True
        )
    ]
    return StampedBytes(vector_message(0, names, *fields), *(f for f in fields if f.size))


def values_of(
    message: JointState, names: Sequence[str], topic: str, field: str = "position"
) -> np.ndarray:
    """Return the finite values (n_names,) of a message, in the order of names.

    field: "position", "velocity" or "effort". Further names in the message are ignored, so that a
    foreign publisher may add its own. Raises InputError for a missing or doubled name, a length
    that differs from that of the names (other fields may be empty), or a value that is not finite.
    """
    values = np.array(getattr(message, field), dtype=np.float64)
    n_names = len(message.name)
    if len(values) != n_names:
        raise InputError(
            f"{topic}: expected one {field} per name, got {len(values)} for {n_names} names"
        )
    lengths = [len(message.position), len(message.velocity), len(message.effort)]
    if not {0, n_names}.issuperset(lengths):
        raise InputError(
            f"{topic}: expected fields of {n_names} entries, one per name, or none, got {lengths}"
        )
    if message.name != list(names):
        values = values[_indices(message.name, names, topic)]
    if not np.isfinite(values).all():
        raise InputError(f"{topic}: expected finite values, got {field} {values.tolist()}")
    return values


def whole_values_of(message: JointState, names: Sequence[str], topic: str) -> list[int]:
    """Return positions that count something, in the order of names.

    Raises InputError as `values_of`, and for a value that is no whole number from 0 to 2^53.
    """
    values = values_of(message, names, topic)
    if not ((values >= 0.0) & (values <= _MAX_WHOLE) & (values == np.floor(values))).all():
        raise InputError(
            f"{topic}: expected whole numbers from 0 to 2^53 as {', '.join(names)}, "
            f"got {values.tolist()}"
        )
    return [int(value) for value in values]


def _indices(have: Sequence[str], want: Sequence[str], topic: str) -> list[int]:
    place = {name: i for i, name in enumerate(have)}
    if len(place) != len(have):
        doubled = sorted({name for name in have if list(have).count(name) > 1})
        raise InputError(f"{topic}: expected each name once, got {', '.join(doubled)} twice")
    missing = [name for name in want if name not in place]
    if missing:
        raise InputError(
            f"{topic}: expected names {', '.join(want)}; {', '.join(missing)} did not come"
        )
    return [place[name] for name in want]
