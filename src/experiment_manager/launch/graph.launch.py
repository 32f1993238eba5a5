"""The whole graph: plant, sparse coder, actor-critic, and the manager, at whose end all end.

ros2 launch experiment_manager graph.launch.py run_directory:=runs/first
ros2 launch experiment_manager graph.launch.py run_directory:=runs/first params_file:=config.yaml

params_file may be the config.yaml of any run: it has the parameters of all nodes. Faults are not
repaired, and nodes not started again: `abv run` does that.
"""

from launch import LaunchContext, LaunchDescription
from launch.actions import (
    DeclareLaunchArgument,
    OpaqueFunction,
    RegisterEventHandler,
    SetEnvironmentVariable,
    Shutdown,
    UnsetEnvironmentVariable,
)
from launch.event_handlers import OnProcessExit
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

from experiment_manager.nodes import MANAGER, NODES
from lockstep.machine.environment import changes


def generate_launch_description() -> LaunchDescription:
    """Return the four nodes, in one namespace."""
    return LaunchDescription(
        [
            DeclareLaunchArgument("namespace", default_value="", description="of all nodes"),
            DeclareLaunchArgument(
                "run_directory", default_value="", description="of the run; default runs/<time>"
            ),
            DeclareLaunchArgument(
                "params_file",
                default_value="",
                description="for all nodes",
            ),
            *(
                UnsetEnvironmentVariable(name)
                if value is None
                else SetEnvironmentVariable(name, value)
                for name, value in changes().items()
            ),
            OpaqueFunction(function=_graph),
        ]
    )


def _graph(context: LaunchContext) -> list[Node | RegisterEventHandler]:
    given = {
        name: LaunchConfiguration(name).perform(context)
        for name in ("namespace", "run_directory", "params_file")
    }
    nodes = {package: _node(package, given) for package in NODES}
    end = OnProcessExit(
        target_action=nodes[MANAGER], on_exit=[Shutdown(reason="the run has ended")]
    )
    return [*nodes.values(), RegisterEventHandler(end)]


def _node(package: str, given: dict[str, str]) -> Node:
    parameters: list[str | dict[str, ParameterValue]] = []
    if given["params_file"]:
        parameters.append(given["params_file"])
    if package == MANAGER and given["run_directory"]:
        # Without a type it would be read as YAML, which cuts off " #1".
        directory = ParameterValue(given["run_directory"], value_type=str)
        parameters.append({"run_directory": directory})
    return Node(
        package=package,
        executable=f"{package}_node",
        name=package,
        namespace=given["namespace"],
        output="screen",
        parameters=parameters,
    )
