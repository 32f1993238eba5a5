"""A node's configuration from its ROS parameters."""

import math
import sys
from collections.abc import Callable
from typing import Any, TypeVar

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.node import Node

from lockstep import configuration
from lockstep.settings import LARGEST_INTEGER, LEAST_INTEGER, Declaration, Setting, declarations

Config = TypeVar("Config")

# What rclpy itself declares on every node.
OF_RCLPY = ("use_sim_time", "start_type_description_service", "qos_overrides.")
# Of the eyes: a parameter file gives them to every node, also to one that has no mechanics.
OF_EYES = ("mechanics.", "camera.", "noise.", "lenses.")


def declare_config(node: Node, config_class: type[Config]) -> Config:
    """Declare each field of config_class as a read-only parameter and return the values given.

    Raises InputError for an unknown parameter or one of a wrong type or value: a misspelt name in
    a parameter file must not go unnoticed. Unknown names of the eyes are refused by nodes that have
    mechanics, and passed over by the others.
    """
    given = {
        name: parameter.value
        for name, parameter in node._parameter_overrides.items()
        if not name.startswith(OF_RCLPY)
    }
    known = configuration.flatten(config_class())
    if not any(name.startswith(OF_EYES[0]) for name in known):
        given = {n: v for n, v in given.items() if n in known or not n.startswith(OF_EYES)}
    config = configuration.build(config_class, given)
    values = configuration.flatten(config)
    for declared in declarations(config_class):
        node.declare_parameter(
            declared.name, values[declared.name], descriptor(declared), ignore_override=True
        )
    return config


def descriptor(declared: Declaration) -> ParameterDescriptor:
    """Return what `describe_parameters` answers with: text, unit, bounds in words and numbers."""
    described = ParameterDescriptor(
        read_only=True,
        description=declared.setting.description,
        additional_constraints=declared.setting.expected,
    )
    # ROS has ranges for single numbers only.
    if type(declared.default) is int:
        least, most = _range(declared.setting, LEAST_INTEGER, LARGEST_INTEGER, _next_integer)
        step = declared.setting.multiple_of
        described.integer_range = [IntegerRange(from_value=least, to_value=most, step=step)]
    elif type(declared.default) is float:
        largest = sys.float_info.max
        least, most = map(float, _range(declared.setting, -largest, largest, math.nextafter))
        described.floating_point_range = [FloatingPointRange(from_value=least, to_value=most)]
    return described


def _range(
    setting: Setting, least: Any, most: Any, next_to: Callable[[Any, float], Any]
) -> tuple[Any, Any]:
    """Return the least and the largest number allowed; least, most: of all numbers of the type.

    next_to: the neighbour of a number toward another, within an exclusive bound.
    """
    if setting.least is not None:
        least = setting.least
    if setting.above is not None:
        least = next_to(setting.above, math.inf)
    if setting.most is not None:
        most = setting.most
    if setting.below is not None:
        most = next_to(setting.below, -math.inf)
    return least, most


def _next_integer(number: int, toward: float) -> int:
    return number + 1 if toward > number else number - 1
