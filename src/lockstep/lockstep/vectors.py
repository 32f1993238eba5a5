"""Stamped vectors of named doubles, carried by sensor_msgs/JointState.

JointState is the one standard message that names its numbers, and every plotting tool reads it.
"""

import array
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from rclpy.node import Node
from rclpy.publisher import Publisher
from sensor_msgs.msg import JointState

from lockstep.errors import InputError
from lockstep.qos import LOCKSTEP_QOS
from lockstep.stamped_bytes import StampedBytes, deserialized
from lockstep.stamps import checked_ns, to_time

# Up to here every whole number is a double of its own.
_MAX_WHOLE = 2.0**53
_FIRST_PLACE = np.uint64(0x7FF4_0000_0000_0000)
_NO_VALUES = np.zeros(0)

Values = np.ndarray | Sequence[float]


@dataclass(frozen=True, slots=True)
class Vector:
    """What a message of named values holds, under the names of sensor_msgs/JointState.

    position, velocity, effort: (n_names,) float64 or empty, not to be written to.
    """

    stamp_ns: int
    name: list[str]
    position: np.ndarray
    velocity: np.ndarray
    effort: np.ndarray


def _doubles(values: Values) -> array.array:
    return array.array("d", np.asarray(values, dtype=np.float64).tobytes())


def vector_message(
    stamp_ns: int,
    names: Sequence[str],
    position: Values,
    velocity: Values = (),
    effort: Values = (),
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


class VectorBytes:
    """Serializes vectors with fixed names."""

    def __init__(self, names: Sequence[str]) -> None:
        """names: the entries of each vector, in order."""
        self._names = tuple(names)
        self._layouts: dict[tuple[bool, bool], StampedBytes] = {}

    def of(
        self, stamp_ns: int, position: Values, velocity: Values = (), effort: Values = ()
    ) -> bytes:
        """Return the message of (n_names,) values; velocity and effort may be empty."""
        has_velocity, has_effort = len(velocity) > 0, len(effort) > 0
        layout = self._layouts.get((has_velocity, has_effort))
        if layout is None:
            n_names = len(self._names)
            layout = _layout(
                JointState(name=self._names),
                (n_names, n_names * has_velocity, n_names * has_effort),
            )
            self._layouts[has_velocity, has_effort] = layout
        values = [position]
        if has_velocity:
            values.append(velocity)
        if has_effort:
            values.append(effort)
        return layout.fill(stamp_ns, *values)


class VectorPublisher:
    """Publishes vectors with fixed names on one topic, and can repeat the last one."""

    def __init__(self, node: Node, topic: str, names: Sequence[str]) -> None:
        """names: the entries of each vector, in order."""
        self.publisher: Publisher = node.create_publisher(JointState, topic, LOCKSTEP_QOS)
        self._bytes = VectorBytes(names)
        self._last = b""

    def publish(
        self, stamp_ns: int, position: Values, velocity: Values = (), effort: Values = ()
    ) -> None:
        """Publish (n_names,) values; velocity and effort may be empty."""
        self._last = self._bytes.of(stamp_ns, position, velocity, effort)
        self.publisher.publish(self._last)

    def repeat(self) -> None:
        """Publish the last vector again, if there was one."""
        if self._last:
            self.publisher.publish(self._last)


class VectorReader:
    """Reads the serialized vectors of one topic."""

    def __init__(self, topic: str) -> None:
        """topic: for error messages."""
        self._topic = topic
        self._name: list[str] = []
        self._is_there: tuple[bool, ...] = ()
        self._layout: StampedBytes | None = None

    def read(self, data: bytes) -> Vector:
        """Return what a message holds, quickly when it is laid out like the one before.

        Raises InputError for bytes that are no sensor_msgs/JointState, and for its stamp.
        """
        found = self._layout.read(data) if self._layout is not None else None
        if found is None:
            message = deserialized(data, JointState, self._topic)
            stamp_ns = checked_ns(message.header.stamp)
            fields = [np.array(f) for f in (message.position, message.velocity, message.effort)]
            self._name = message.name
            self._is_there = tuple(field.size > 0 for field in fields)
            self._layout = None
            if any(self._is_there):
                layout = _layout(message, [field.size for field in fields])
                self._layout = layout if layout.expect(data) else None
            return Vector(stamp_ns, self._name, *fields)
        stamp_ns, present = found
        fields = [present.pop(0) if is_there else _NO_VALUES for is_there in self._is_there]
        return Vector(stamp_ns, self._name, *fields)


def _layout(message: JointState, sizes: Sequence[int]) -> StampedBytes:
    """Return the message with so many values as position, velocity and effort.

    The message itself is left without values.
    """
    # Numbers that are no numbers, each another: no name and no length looks like them.
    places = (np.arange(sum(sizes), dtype=np.uint64) + _FIRST_PLACE).view(np.float64)
    fields = np.split(places, np.cumsum(sizes)[:-1])
    message.position, message.velocity, message.effort = map(_doubles, fields)
    return StampedBytes(message, *(field for field in fields if field.size))


def values_of(
    message: JointState | Vector, names: Sequence[str], topic: str, field: str = "position"
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
        values = values[_indices(tuple(message.name), tuple(names), topic)]
    if not np.isfinite(values).all():
        raise InputError(f"{topic}: expected finite values, got {field} {values.tolist()}")
    return values


def whole_values_of(message: JointState | Vector, names: Sequence[str], topic: str) -> list[int]:
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


@lru_cache(maxsize=8)  # the same few names come each time
def _indices(have: tuple[str, ...], want: tuple[str, ...], topic: str) -> list[int]:
    place = {name: i for i, name in enumerate(have)}
    if len(place) != len(have):
        doubled = sorted({name for name in have if have.count(name) > 1})
        raise InputError(f"{topic}: expected each name once, got {', '.join(doubled)} twice")
    missing = [name for name in want if name not in place]
    if missing:
        raise InputError(
            f"{topic}: expected names {', '.join(want)}; {', '.join(missing)} did not come"
        )
    return [place[name] for name in want]
