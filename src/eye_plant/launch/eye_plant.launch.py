"""The plant alone, free-running: commands act on arrival.

ros2 launch eye_plant eye_plant.launch.py rate_hz:=100.0 parameter_set:=anatomical
"""

from typing import Any

from launch import LaunchContext, LaunchDescription
from launch.actions import (
    DeclareLaunchArgument,
    OpaqueFunction,
    SetEnvironmentVariable,
    UnsetEnvironmentVariable,
)
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

from lockstep.machine.environment import changes

RATE_HZ = 100.0
_ARGUMENTS = {
    "namespace": "of the node",
    "rate_hz": f"observations a second; {RATE_HZ:g}",
    "parameter_set": "k17 or anatomical; k17",
    "params_file": "takes precedence over the defaults",
}


def generate_launch_description() -> LaunchDescription:
    """Return the node: the user's file takes precedence over defaults, arguments over both."""
    return LaunchDescription(
        [
            *(
                DeclareLaunchArgument(name, default_value="", description=text)
                for name, text in _ARGUMENTS.items()
            ),
            *(
                UnsetEnvironmentVariable(name)
                if value is None
                else SetEnvironmentVariable(name, value)
                for name, value in changes().items()
            ),
            OpaqueFunction(function=_plant),
        ]
    )


def _plant(context: LaunchContext) -> list[Node]:
    given = {name: LaunchConfiguration(name).perform(context) for name in _ARGUMENTS}
    parameters: list[str | dict[str, Any]] = [{"free_running.rate_hz": RATE_HZ}]
    if given["params_file"]:
        parameters.append(given["params_file"])
    if given["rate_hz"]:
        parameters.append({"free_running.rate_hz": float(given["rate_hz"])})
    if given["parameter_set"]:
        parameters.append({"mechanics.parameter_set": given["parameter_set"]})
    return [
        Node(
            package="eye_plant",
            executable="eye_plant_node",
            name="eye_plant",
            namespace=given["namespace"],
            output="screen",
            parameters=parameters,
        )
    ]
