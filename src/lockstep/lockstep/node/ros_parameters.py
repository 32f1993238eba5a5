"""A node's configuration from its ROS parameters."""

import math
import sys
from typing import TypeVar

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.node import Node

from lockstep import configuration
from lockstep.settings import LARGEST_INTEGER, LEAST_INTEGER, Declaration, Setting, declarations

Config = TypeVar("Config")

# What rclpy itself declares on every node.
OF_RCLPY = ("use_sim_time", "start_type_description_service", "qos_overrides.")


def declare_config(node: Node, config_class: type[Config]) -> Config:
    """Declare each field of config_class as a read-only parameter and return the values given.

    Raises InputError for an unknown parameter or one of a wrong type or value: a misspelt name in
    a parameter file must not go unnoticed.
    """
    given = {
        name: parameter.value
        for name, parameter in node._parameter_overrides.items()
        if not name.startswith(OF_RCLPY)
    }
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
        described.integer_range = [_integer_range(declared.setting)]
    elif type(declared.default) is float:
        described.floating_point_range = [_floating_point_range(declared.setting)]
    return described


def _integer_range(setting: Setting) -> IntegerRange:
    least, most = LEAST_INTEGER, LARGEST_INTEGER
    if setting.least is not None:
        least = math.ceil(setting.least)
    if setting.above is not None:
        least = math.floor(setting.above) + 1
    if setting.most is not None:
        most = math.floor(setting.most)
    if setting.below is not None:
        most = math.ceil(setting.below) - 1
    return IntegerRange(from_value=least, to_value=most, step=setting.multiple_of)


def _floating_point_range(setting: Setting) -> FloatingPointRange:
    """Return the range; an exclusive bound becomes the next number within it."""
    least, most = -sys.float_info.max, sys.float_info.max
    if setting.least is not None:
        least = float(setting.least)
    if setting.above is not None:
        least = math.nextafter(setting.above, math.inf)
    if setting.most is not None:
        most = float(setting.most)
    if setting.below is not None:
        most = math.nextafter(setting.below, -math.inf)
    return FloatingPointRange(from_value=least, to_value=most)
