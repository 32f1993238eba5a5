"""Configuration: dataclasses to dotted names and back, and what is refused."""

import re
from dataclasses import dataclass, field
from typing import Any

import pytest

from lockstep import InputError, build, flatten


@dataclass(frozen=True)
class Inner:
    gain: float = 0.5
    limits: tuple[float, ...] = (0.0, 1.0)
    names: tuple[str, ...] = ("a",)

    def __post_init__(self) -> None:
        if self.gain < 0.0:
            raise ValueError(f"gain: expected 0 or more, got {self.gain}")


@dataclass(frozen=True)
class Outer:
    seed: int = 1
    fast: bool = False
    label: str = ""
    inner: Inner = field(default_factory=Inner)


DEFAULTS = {
    "seed": 1,
    "fast": False,
    "label": "",
    "inner.gain": 0.5,
    "inner.limits": [0.0, 1.0],
    "inner.names": ["a"],
}


def test_flatten_names_nested_fields_with_dots() -> None:
    assert flatten(Outer()) == DEFAULTS


def test_flatten_and_build_are_inverse() -> None:
    config = Outer(7, True, "x", Inner(0.25, (1.0, 2.0, 3.0), ("p", "q")))
    assert build(Outer, flatten(config)) == config


def test_a_whole_number_passes_for_a_number() -> None:
    gain = build(Outer, {"inner.gain": 2}).inner.gain
    assert gain == 2.0
    assert type(gain) is float


def test_a_list_becomes_a_tuple_of_its_type() -> None:
    assert build(Outer, {"inner.limits": [1, 2.5]}).inner.limits == (1.0, 2.5)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"sead": 1}, "unknown parameter sead: did you mean seed?"),
        ({"inner": 1}, "unknown parameter inner"),
        ({"inner.gain.x": 1.0}, "unknown parameter inner.gain.x"),
        ({"seed": 1.5}, "seed: expected an integer, got 1.5"),
        ({"seed": "1"}, "seed: expected an integer, got '1'"),
        ({"seed": True}, "seed: expected an integer, got True"),
        ({"fast": 1}, "fast: expected a boolean, got 1"),
        ({"label": 3}, "label: expected a string, got 3"),
        ({"inner.gain": True}, "inner.gain: expected a number, got True"),
        ({"inner.gain": None}, "inner.gain: expected a number, got None"),
        ({"inner.gain": 10**400}, "inner.gain: expected a number of 64 bits, got 1000"),
        ({"inner.limits": []}, "inner.limits: expected a list with entries, got []"),
        ({"inner.limits": 1.0}, "inner.limits: expected a list with entries, got 1.0"),
        ({"inner.names": "abc"}, "inner.names: expected a list with entries, got 'abc'"),
        ({"inner.limits": [0.0, "x"]}, "inner.limits[1]: expected a number, got 'x'"),
        ({"inner.gain": -1.0}, "inner.gain: expected 0 or more, got -1.0"),
    ],
)
def test_bad_values_are_one_clear_error(values: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=re.escape(message)):
        build(Outer, values)
