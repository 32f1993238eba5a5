"""Frozen dataclasses as configuration, and the flat, dotted names of ROS parameters.

A configuration class has fields of type bool, int, float, str, tuple[float, ...], tuple[int, ...],
tuple[str, ...], or of another configuration class; every field has a default, and a tuple has at
least one entry (ROS parameters have no empty list of a type). Field ``b`` of the nested
configuration ``a`` is the parameter ``a.b``. Bounds and texts of fields: `lockstep.settings`.
"""

import dataclasses
import typing
from collections.abc import Mapping, Sequence
from typing import Any, TypeVar

from lockstep.errors import InputError
from lockstep.written.nearest import listed, nearest

Config = TypeVar("Config")

_NAMES = {bool: "a boolean", int: "an integer", float: "a number", str: "a string"}


def flatten(config: Any) -> dict[str, Any]:
    """Return {dotted name: value} of a configuration; tuples become lists, as in YAML."""
    flat: dict[str, Any] = {}
    for field in dataclasses.fields(config):
        value = getattr(config, field.name)
        if dataclasses.is_dataclass(value):
            flat |= {f"{field.name}.{name}": v for name, v in flatten(value).items()}
        else:
            flat[field.name] = list(value) if isinstance(value, tuple) else value
    return flat


def build(config_class: type[Config], values: Mapping[str, Any]) -> Config:
    """Return a configuration with the given values, by dotted name, and defaults elsewhere.

    Raises InputError for an unknown name, a value of another type, or one that the class refuses.
    """
    default = config_class()
    unknown = sorted(set(values) - set(flatten(default)))
    if unknown:
        raise InputError(f"unknown parameter {', '.join(unknown)}: {_meant(unknown, default)}")
    return _build(config_class, values, "")


def _meant(unknown: Sequence[str], default: Any) -> str:
    known = sorted(flatten(default))
    near = list(dict.fromkeys(name for wrong in unknown for name in nearest(wrong, known)))
    return f"did you mean {' or '.join(near)}?" if near else f"expected some of {listed(known)}"


def _build(config_class: type[Config], values: Mapping[str, Any], prefix: str) -> Config:
    hints = typing.get_type_hints(config_class)
    arguments: dict[str, Any] = {}
    for field in dataclasses.fields(config_class):  # type: ignore[arg-type]
        name, hint = prefix + field.name, hints[field.name]
        if dataclasses.is_dataclass(hint):
            arguments[field.name] = _build(typing.cast(type, hint), values, name + ".")
        elif name in values:
            arguments[field.name] = typed(name, hint, values[name])
    try:
        return config_class(**arguments)
    except ValueError as error:  # its text begins with the field's name
        raise InputError(f"{prefix}{error}") from error


def typed(name: str, hint: Any, value: Any) -> Any:
    """Return value as the type of a field: 1 passes for 1.0, 1e6 for 1000000, a list for a tuple.

    name: for the error text; hint: one of the types above. Raises InputError for another type.
    """
    if typing.get_origin(hint) is tuple:
        (kind, _) = typing.get_args(hint)
        if isinstance(value, str) or not hasattr(value, "__iter__") or not len(value):
            raise InputError(f"{name}: expected a list with entries, got {value!r}")
        return tuple(typed(f"{name}[{i}]", kind, entry) for i, entry in enumerate(value))
    if hint is float and isinstance(value, int) and not isinstance(value, bool):
        try:
            return float(value)
        except OverflowError as error:
            raise InputError(f"{name}: expected a number of 64 bits, got {value}") from error
    if hint is int and isinstance(value, float) and value.is_integer():
        return int(value)  # 1e6
    if type(value) is not hint:
        raise InputError(f"{name}: expected {_NAMES[hint]}, got {value!r}")
    return value
