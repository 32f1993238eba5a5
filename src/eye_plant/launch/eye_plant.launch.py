"""The plant alone, free-running: commands act on arrival.

ros2 launch eye_plant eye_plant.launch.py rate_hz:=100.0 parameter_set:=anatomical
"""

from pathlib import Path

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, SetEnvironmentVariable
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

from lockstep.node.launch_environment import launch_environment


def generate_launch_description() -> LaunchDescription:
    """Return the node with its parameter file; arguments win."""
    variables = launch_environment(Path(get_package_share_directory("lockstep")))
    config = Path(get_package_share_directory("eye_plant")) / "config" / "eye_plant.yaml"
    return LaunchDescription(
        [
            DeclareLaunchArgument("namespace", default_value="", description="of the node"),
            DeclareLaunchArgument(
                "rate_hz", default_value="100.0", description="observations a second"
            ),
            DeclareLaunchArgument(
                "parameter_set", default_value="k17", description="k17 or anatomical"
            ),
            DeclareLaunchArgument(
                "params_file", default_value=str(config), description="of all its parameters"
            ),
            *(SetEnvironmentVariable(name, value) for name, value in variables.items()),
            Node(
                package="eye_plant",
                executable="node",
                name="eye_plant",
                namespace=LaunchConfiguration("namespace"),
                output="screen",
                parameters=[
                    LaunchConfiguration("params_file"),
                    {
                        "free_running.rate_hz": ParameterValue(
                            LaunchConfiguration("rate_hz"), value_type=float
                        ),
                        "mechanics.parameter_set": LaunchConfiguration("parameter_set"),
                    },
                ],
            ),
        ]
    )
