"""Vectors of named doubles: what goes out, what may come in."""

import array
import math
import re
from typing import Any

import numpy as np
import pytest
from sensor_msgs.msg import JointState

from lockstep import InputError
from lockstep.wire.vectors import values_of, vector_message, whole_values_of


def _message(names: list[str], **fields: list[float]) -> JointState:
    message = JointState(name=names)
    for field, values in fields.items():
        setattr(message, field, array.array("d", values))
    return message


def test_a_message_holds_stamp_names_and_values_bit_for_bit() -> None:
    values = np.array([0.1, -0.0, 5e-324, 1.7976931348623157e308])
    message = vector_message(2_000_000_005, "abcd", values, (), [0.5, -0.5, 0.0, 1.0])
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (2, 5)
    assert message.name == ["a", "b", "c", "d"]
    assert values_of(message, "abcd", "t").tobytes() == values.tobytes()
    assert list(message.velocity) == []
    assert list(message.effort) == [0.5, -0.5, 0.0, 1.0]


def test_values_come_in_the_order_asked_for_and_others_are_ignored() -> None:
    message = _message(["x", "b", "a"], position=[9.0, 2.0, 1.0])
    assert values_of(message, ("a", "b"), "t").tolist() == [1.0, 2.0]


@pytest.mark.parametrize(
    ("message", "expected"),
    [
        (_message(["a"], position=[1.0, 2.0]), "t: expected one position per name, got 2 for 1"),
        (_message(["a", "b"], position=[]), "t: expected one position per name, got 0 for 2"),
        (_message(["a"], effort=[1.0]), "t: expected one position per name, got 0 for 1"),
        (
            _message(["a"], position=[1.0], velocity=[1.0, 1.0]),
            "t: expected fields of 1 entries, one per name, or none, got [1, 2, 0]",
        ),
        (
            _message(["a"], position=[1.0], effort=[1.0, 1.0]),
            "t: expected fields of 1 entries, one per name, or none, got [1, 0, 2]",
        ),
        (_message(["b"], position=[1.0]), "t: expected names a; a did not come"),
        (_message([], position=[]), "t: expected names a; a did not come"),
        (_message(["a", "a"], position=[1.0, 1.0]), "t: expected each name once, got a twice"),
        (_message(["a"], position=[math.nan]), "t: expected finite values, got a nan"),
        (_message(["a"], position=[math.inf]), "t: expected finite values, got a inf"),
    ],
)
def test_bad_vectors_are_one_clear_error(message: JointState, expected: str) -> None:
    with pytest.raises(InputError, match=re.escape(expected)):
        values_of(message, ("a",), "t")


def test_nan_may_stand_only_for_what_may_be_lacking() -> None:
    message = _message(["a", "b"], position=[math.nan, 1.0])
    assert values_of(message, ("b", "a"), "t", may_lack=("a",))[0] == 1.0
    with pytest.raises(InputError, match="t: expected finite values, got a nan"):
        values_of(message, ("b", "a"), "t", may_lack=("b",))
    message.position = [math.inf, 1.0]
    with pytest.raises(InputError, match="t: expected finite values, got a inf"):
        values_of(message, ("b", "a"), "t", may_lack=("a", "b"))


def test_another_fields_values() -> None:
    message = _message(["a"], position=[1.0], effort=[3.0])
    assert values_of(message, ("a",), "t", "effort").tolist() == [3.0]


def test_whole_values() -> None:
    message = _message(["n", "m"], position=[3.0, 2.0**52])
    assert whole_values_of(message, ("n", "m"), "t") == [3, 2**52]


@pytest.mark.parametrize("value", [0.5, -1.0, 2.0**53 + 2, 1e300])
def test_what_is_no_count_is_refused(value: Any) -> None:
    with pytest.raises(InputError, match="t: expected whole numbers from 0 to 2"):
        whole_values_of(_message(["n"], position=[value]), ("n",), "t")
