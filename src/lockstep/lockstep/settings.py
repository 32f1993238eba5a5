"""One declaration per setting: its default, bounds, unit and text, from which all else follows.

A field declared with `setting` is checked by `check_settings`, described to ROS by
`lockstep.node.ros_parameters`, and listed for the parameter files and the docs by `declarations`.
"""

import dataclasses
import math
import typing
from typing import Any

from lockstep.errors import InputError

# What a ROS parameter can hold.
LEAST_INTEGER, LARGEST_INTEGER = -(2**63), 2**63 - 1
REQUIRED: Any = dataclasses.MISSING
_KEY = "setting"


@dataclasses.dataclass(frozen=True)
class Setting:
    """What is known of a field beside its name, type and default.

    text: what it means, one sentence without a full stop; unit: "" for none.
    least, most: inclusive bounds; above, below: exclusive ones; a tuple's hold for each entry.
    multiple_of: of whole numbers; choices: the texts allowed, () for all.
    n_entries: of a tuple, 0 for any number; is_interval: two entries, the lowest and the highest.
    """

    text: str
    unit: str = ""
    least: float | None = None
    most: float | None = None
    above: float | None = None
    below: float | None = None
    multiple_of: int = 1
    choices: tuple[str, ...] = ()
    n_entries: int = 0
    is_interval: bool = False

    @property
    def description(self) -> str:
        """The text with its unit."""
        return f"{self.text} [{self.unit}]" if self.unit else self.text

    @property
    def expected(self) -> str:
        """What a value must be, in words; "" if its type says it all."""
        if self.choices:
            return " or ".join(self.choices)
        parts = [f"a multiple of {self.multiple_of}"] if self.multiple_of > 1 else []
        each = ", ".join(parts + self._bounds())
        if self.is_interval:
            return "[lowest, highest]" + (f", each {each}" if each else "")
        if self.n_entries:
            return f"{self.n_entries} numbers" + (f", each {each}" if each else "")
        return each

    def _bounds(self) -> list[str]:
        unit = f" {self.unit}" if self.unit.isalpha() else ""
        if self.least is not None and self.most is not None:
            return [f"{self.least} to {self.most}{unit}"]
        ends = (
            (self.least, f"{self.least}{unit} or more"),
            (self.above, f"more than {self.above}{unit}"),
            (self.most, f"{self.most}{unit} or less"),
            (self.below, f"less than {self.below}{unit}"),
        )
        return [text for bound, text in ends if bound is not None]

    def allows(self, value: Any) -> bool:
        """Whether a value of the field's type is within the bounds; NaN and infinity never are."""
        if not isinstance(value, tuple):
            return self._allows_entry(value)
        n_entries = 2 if self.is_interval else self.n_entries
        return (
            (not n_entries or len(value) == n_entries)
            and all(self._allows_entry(entry) for entry in value)
            and (not self.is_interval or value[0] <= value[1])
        )

    def _allows_entry(self, value: Any) -> bool:
        if isinstance(value, str):
            return not self.choices or value in self.choices
        return (
            (not isinstance(value, float) or math.isfinite(value))
            and (self.least is None or value >= self.least)
            and (self.most is None or value <= self.most)
            and (self.above is None or value > self.above)
            and (self.below is None or value < self.below)
            and (self.multiple_of == 1 or value % self.multiple_of == 0)
        )


@dataclasses.dataclass(frozen=True)
class Declaration:
    """A setting by its dotted name, with its default."""

    name: str
    default: Any
    setting: Setting


def setting(default: Any, text: str, unit: str = "", **bounds: Any) -> Any:
    """Return a dataclass field whose value `check_settings` checks.

    default: REQUIRED for none; text, unit, bounds: the fields of `Setting`.
    """
    metadata = {_KEY: Setting(text, unit, **bounds)}
    return dataclasses.field(default=default, metadata=metadata)


def check_settings(config: Any) -> None:
    """Check each field of a dataclass that was declared with `setting`; for __post_init__.

    Raises InputError that names the first field out of bounds, what was expected and what came.
    """
    for field in dataclasses.fields(config):
        declared: Setting | None = field.metadata.get(_KEY)
        value = getattr(config, field.name)
        _check_whole_numbers(field.name, value)
        if declared is not None and not declared.allows(value):
            shown = list(value) if isinstance(value, tuple) else value
            expected = declared.expected or "a finite number"
            raise InputError(f"{field.name}: expected {expected}, got {shown!r}")


def _check_whole_numbers(name: str, value: Any) -> None:
    for entry in value if isinstance(value, tuple) else (value,):
        if isinstance(entry, int) and not LEAST_INTEGER <= entry <= LARGEST_INTEGER:
            raise InputError(
                f"{name}: expected a whole number from {LEAST_INTEGER} to {LARGEST_INTEGER}, "
                f"got {entry}"
            )


def declarations(config_class: type) -> list[Declaration]:
    """Return all settings of a configuration class and of those nested in it, in their order.

    Raises TypeError for a field that was not declared with `setting`.
    """
    hints = typing.get_type_hints(config_class)
    found: list[Declaration] = []
    for field in dataclasses.fields(config_class):
        hint = hints[field.name]
        if dataclasses.is_dataclass(hint):
            nested = declarations(typing.cast(type, hint))
            found += [dataclasses.replace(d, name=f"{field.name}.{d.name}") for d in nested]
        elif _KEY not in field.metadata:
            raise TypeError(
                f"{config_class.__name__}.{field.name}: expected a field made by setting()"
            )
        else:
            found.append(Declaration(field.name, field.default, field.metadata[_KEY]))
    return found
