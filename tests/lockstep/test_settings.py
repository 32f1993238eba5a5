"""Declarations of settings: what they allow, how they refuse, and what can be listed."""

import math
import re
from dataclasses import dataclass, field, fields
from typing import Any

import pytest

from lockstep import InputError, check_settings, setting
from lockstep.settings import REQUIRED, Setting, declarations


@dataclass(frozen=True)
class Eye:
    size_m: float = setting(0.02, "diameter of the globe", "m", above=0, most=1)
    limits: tuple[float, ...] = setting((0.0, 0.5), "limits", least=0, most=1, is_interval=True)
    gains: tuple[float, ...] = setting((1.0, 1.0), "gain of each axis", n_entries=2)
    width_px: int = setting(8, "width", "px", least=2, multiple_of=2)
    share: float = setting(0.5, "share", least=0, below=1)
    depths: tuple[int, ...] = setting((1, 2), "depths", least=0)
    free: float = setting(0.0, "any number")
    number: int = setting(0, "any whole number")

    def __post_init__(self) -> None:
        check_settings(self)


@dataclass(frozen=True)
class Head:
    model: str = setting("M", "model", choices=("M", "M_C"))
    eye: Eye = field(default_factory=Eye)

    def __post_init__(self) -> None:
        check_settings(self)


@pytest.mark.parametrize(
    "values",
    [
        {"size_m": 1.0},
        {"limits": (0.0, 1.0)},
        {"limits": (0.3, 0.3)},
        {"gains": (-1e300, 1e300)},
        {"width_px": 2**63 - 2},
        {"share": math.nextafter(1.0, 0.0)},
        {"depths": (0,)},
        {"number": -(2**63)},
        {"number": 2**63 - 1},
        {"free": -1e300},
    ],
)
def test_what_is_within_the_bounds_is_allowed(values: dict[str, Any]) -> None:
    assert {name: getattr(Eye(**values), name) for name in values} == values


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"size_m": 0.0}, "size_m: expected more than 0 m, 1 m or less, got 0.0"),
        ({"size_m": 1.5}, "size_m: expected more than 0 m, 1 m or less, got 1.5"),
        ({"limits": (0.5, 0.4)}, "limits: expected [lowest, highest], each 0 to 1, got [0.5, 0.4]"),
        ({"limits": (0.5,)}, "limits: expected [lowest, highest], each 0 to 1, got [0.5]"),
        ({"limits": (0.5, 1.1)}, "limits: expected [lowest, highest], each 0 to 1, got [0.5, 1.1]"),
        ({"gains": (1.0,)}, "gains: expected 2 numbers, got [1.0]"),
        ({"gains": (1.0, math.inf)}, "gains: expected 2 numbers, got [1.0, inf]"),
        ({"width_px": 3}, "width_px: expected a multiple of 2, 2 px or more, got 3"),
        ({"width_px": 0}, "width_px: expected a multiple of 2, 2 px or more, got 0"),
        ({"share": 1.0}, "share: expected 0 or more, less than 1, got 1.0"),
        ({"share": math.nan}, "share: expected 0 or more, less than 1, got nan"),
        ({"depths": (1, -1)}, "depths: expected 0 or more, got [1, -1]"),
        (
            {"number": 2**63},
            "number: expected a whole number from -9223372036854775808 to 9223372036854775807, "
            "got 9223372036854775808",
        ),
        (
            {"number": -(2**63) - 1},
            "number: expected a whole number from -9223372036854775808 to 9223372036854775807, "
            "got -9223372036854775809",
        ),
        ({"free": math.inf}, "free: expected a finite number, got inf"),
    ],
)
def test_what_is_out_of_bounds_is_refused(values: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=f"^{re.escape(message)}$"):
        Eye(**values)


def test_one_of_some_choices() -> None:
    assert Head(model="M_C").model == "M_C"
    with pytest.raises(InputError, match=r"^model: expected M or M_C, got 'X'$"):
        Head(model="X")


def test_a_setting_without_a_default_is_required() -> None:
    @dataclass(frozen=True)
    class Request:
        number: int = setting(REQUIRED, "number", least=0)

    assert Request(number=3).number == 3
    with pytest.raises(TypeError, match="number"):
        Request()


def test_all_settings_are_listed_by_their_dotted_names() -> None:
    listed = declarations(Head)
    assert [d.name for d in listed] == [
        "model",
        *(f"eye.{field.name}" for field in fields(Eye)),
    ]
    assert listed[1].default == 0.02
    assert listed[1].setting == Setting("diameter of the globe", "m", above=0, most=1)
    assert listed[1].setting.description == "diameter of the globe [m]"


def test_a_field_that_was_not_declared_cannot_be_listed() -> None:
    @dataclass(frozen=True)
    class Careless:
        gain: float = 1.0

    with pytest.raises(TypeError, match=r"Careless\.gain: expected a field made by setting\(\)"):
        declarations(Careless)
