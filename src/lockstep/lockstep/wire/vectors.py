"""Stamped vectors of named doubles, carried by sensor_msgs/JointState.

JointState is the one standard message that names its numbers, and every plotting tool reads it.
"""

import array
import math
from collections.abc import Collection, Sequence
from functools import lru_cache

import numpy as np
from rclpy.node import Node
from sensor_msgs.msg import JointState

from lockstep.errors import InputError
from lockstep.wire.cdr import deserialized
from lockstep.wire.codec import Writer
from lockstep.wire.publisher import RepeatingPublisher
from lockstep.wire.stamps import to_time

# Up to here every whole number is a double of its own.
_MAX_WHOLE = 2.0**53

Values = np.ndarray | Sequence[float]


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


def read_vector(data: bytes, topic: str) -> JointState:
    """Return a serialized message; InputError, which names the topic, when it is no vector."""
    message: JointState = deserialized(data, JointState, topic)
    return message


class VectorBytes:
    """Serializes vectors with fixed names."""

    def __init__(self, names: Sequence[str]) -> None:
        """names: the entries of each vector, in order."""
        self._names = tuple(names)
        self._writers: dict[tuple[bool, bool], Writer] = {}

    def of(
        self, stamp_ns: int, position: Values, velocity: Values = (), effort: Values = ()
    ) -> bytes:
        """Return the message of (n_names,) values; velocity and effort may be empty."""
        has = len(velocity) > 0, len(effort) > 0
        fields = [position, *([velocity] if has[0] else []), *([effort] if has[1] else [])]
        if has not in self._writers:
            self._writers[has] = Writer(
                vector_message(stamp_ns, self._names, position, velocity, effort)
            )
        return self._writers[has](stamp_ns, *fields)


class VectorPublisher(RepeatingPublisher):
    """Publishes vectors, (n_names,) or empty each, as `VectorBytes.of` takes them."""

    def __init__(self, node: Node, topic: str, names: Sequence[str]) -> None:
        """names: the entries of each vector, in order."""
        super().__init__(node, JointState, topic, VectorBytes(names).of)


def values_of(
    message: JointState,
    names: Sequence[str],
    topic: str,
    field: str = "position",
    *,
    may_lack: Collection[str] = (),
) -> np.ndarray:
    """Return the finite values (n_names,) of a message, in the order of names.

    field: "position", "velocity" or "effort". Further names in the message are ignored, so that a
    foreign publisher may add its own; may_lack: names of which NaN may say that there is nothing.
    Raises InputError for a missing or doubled name, a length that differs from that of the names
    (other fields may be empty), or a value that is not finite.
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
    check_finite(values, names, topic, may_lack)
    return values


def check_finite(
    values: np.ndarray, names: Sequence[str], topic: str, may_lack: Collection[str] = ()
) -> None:
    """Raise InputError, naming them, for values that are not finite, except NaN of may_lack."""
    if np.isfinite(values).all():
        return
    wrong = {
        name: value
        for name, value in zip(names, values.tolist(), strict=True)
        if not (math.isfinite(value) or (math.isnan(value) and name in may_lack))
    }
    if wrong:
        got = ", ".join(f"{name} {value}" for name, value in wrong.items())
        raise InputError(f"{topic}: expected finite values, got {got}")


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


@lru_cache(maxsize=8)  # the same few names come each time
def _indices(have: tuple[str, ...], want: tuple[str, ...], topic: str) -> list[int]:
    index_of = {name: i for i, name in enumerate(have)}
    if len(index_of) != len(have):
        doubled = sorted({name for name in have if have.count(name) > 1})
        raise InputError(f"{topic}: expected each name once, got {', '.join(doubled)} twice")
    missing = [name for name in want if name not in index_of]
    if missing:
        raise InputError(
            f"{topic}: expected names {', '.join(want)}; {', '.join(missing)} did not come"
        )
    return [index_of[name] for name in want]
