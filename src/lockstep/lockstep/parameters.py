"""A node's configuration from its ROS parameters."""

from typing import TypeVar

from rcl_interfaces.msg import ParameterDescriptor
from rclpy.node import Node

from lockstep import configuration

Config = TypeVar("Config")

# What rclpy itself declares on every node.
_OF_RCLPY = ("use_sim_time", "start_type_description_service", "qos_overrides.")


def declare_config(node: Node, config_class: type[Config]) -> Config:
    """Declare each field of config_class as a read-only parameter and return the values given.

    Raises InputError for an unknown parameter or one of a wrong type or value: a misspelt name in
    a parameter file must not go unnoticed.
    """
    given = {
        name: parameter.value
        for name, parameter in node._parameter_overrides.items()
        if not name.startswith(_OF_RCLPY)
    }
    config = configuration.build(config_class, given)
    for name, value in configuration.flatten(config).items():
        descriptor = ParameterDescriptor(read_only=True)
        node.declare_parameter(name, value, descriptor, ignore_override=True)
    return config
