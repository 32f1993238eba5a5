"""The launch files: with stand-ins for `launch`, which has no wheels, or with it where it is."""

import importlib.util
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from experiment_manager.sections import CONFIG_CLASSES
from lockstep import flatten
from lockstep.machine.environment import changes

ROOT = Path(__file__).parents[2]
PLANT = ROOT / "src/eye_plant/launch/eye_plant.launch.py"
GRAPH = ROOT / "src/experiment_manager/launch/graph.launch.py"


class Call:
    """Whatever a launch file makes, with its arguments."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        self.arguments, self.options = arguments, options

    def perform(self, context: dict[str, str]) -> str:
        """Return the value of a LaunchConfiguration."""
        return context[self.arguments[0]]


_STAND_INS = {
    "launch": "LaunchDescription LaunchContext",
    "launch.actions": "DeclareLaunchArgument OpaqueFunction RegisterEventHandler "
    "SetEnvironmentVariable Shutdown UnsetEnvironmentVariable",
    "launch.event_handlers": "OnProcessExit",
    "launch.substitutions": "LaunchConfiguration",
    "launch_ros": "",
    "launch_ros.actions": "Node",
    "launch_ros.parameter_descriptions": "ParameterValue",
}


@pytest.fixture(autouse=True)
def stand_ins(monkeypatch: pytest.MonkeyPatch) -> None:
    """Put stand-ins where `launch` would be, in the environment of a robot."""
    monkeypatch.setenv("ROS_DISCOVERY_SERVER", "192.0.2.7:11811")
    monkeypatch.delenv("FASTRTPS_DEFAULT_PROFILES_FILE")
    for name, kinds in _STAND_INS.items():
        module = ModuleType(name)
        for kind in kinds.split():
            setattr(module, kind, type(kind, (Call,), {}))
        monkeypatch.setitem(sys.modules, name, module)


def _loaded(file: Path) -> tuple[ModuleType, list[Any]]:
    spec = importlib.util.spec_from_file_location(file.name.replace(".", "_"), file)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    (entities,) = module.generate_launch_description().arguments
    return module, entities


def _of_kind(entities: list[Any], kind: str) -> list[Call]:
    return [entity for entity in entities if type(entity).__name__ == kind]


def _check_node(node: Call, package: str) -> None:
    executable = f"{package}_node"
    assert (node.options["package"], node.options["executable"]) == (package, executable)
    assert node.options["name"] == package
    entry_points = (ROOT / f"src/{package}/setup.py").read_text()
    assert f'"{executable} = {package}.node' in entry_points
    given = [p for p in node.options["parameters"] if isinstance(p, dict)]
    assert {name for parameters in given for name in parameters} <= flatten(
        CONFIG_CLASSES[package]()
    ).keys()


def _check_environment(entities: list[Any]) -> None:
    made = dict(v.arguments for v in _of_kind(entities, "SetEnvironmentVariable"))
    assert Path(made["FASTRTPS_DEFAULT_PROFILES_FILE"]).is_file()
    (unset,) = _of_kind(entities, "UnsetEnvironmentVariable")
    assert unset.arguments == ("ROS_DISCOVERY_SERVER",)
    assert made | {"ROS_DISCOVERY_SERVER": None} == changes()


def _plant_parameters(entities: list[Any], context: dict[str, str]) -> list[Any]:
    (plant,) = _of_kind(entities, "OpaqueFunction")
    (node,) = plant.options["function"](context)
    _check_node(node, "eye_plant")
    parameters: list[Any] = node.options["parameters"]
    return parameters


def test_the_plant_runs_free_with_arguments_above_a_user_s_file_above_the_launch_file() -> None:
    _, entities = _loaded(PLANT)
    _check_environment(entities)
    given = {
        declared.arguments[0]: declared.options["default_value"]
        for declared in _of_kind(entities, "DeclareLaunchArgument")
    }
    (ours,) = _plant_parameters(entities, given)
    assert ours["free_running.rate_hz"] > 0.0
    given |= {"params_file": "mine.yaml"}
    assert _plant_parameters(entities, given) == [ours, "mine.yaml"]
    given |= {"rate_hz": "50", "parameter_set": "anatomical"}
    assert _plant_parameters(entities, given) == [
        ours,
        "mine.yaml",
        {"free_running.rate_hz": 50.0},
        {"mechanics.parameter_set": "anatomical"},
    ]


def test_the_graph_has_four_nodes_and_ends_with_the_manager() -> None:
    module, entities = _loaded(GRAPH)
    _check_environment(entities)
    (graph,) = _of_kind(entities, "OpaqueFunction")
    context = {"namespace": "lab", "run_directory": "runs/x #1", "params_file": "config.yaml"}
    made = graph.options["function"](context)
    nodes = _of_kind(made, "Node")
    for node, package in zip(nodes, module.NODES, strict=True):
        _check_node(node, package)
        assert node.options["namespace"] == "lab"
        assert node.options["parameters"][0] == "config.yaml"
    directory = nodes[-1].options["parameters"][1]["run_directory"]
    assert (directory.arguments, directory.options) == (("runs/x #1",), {"value_type": str})
    (handler,) = _of_kind(made, "RegisterEventHandler")
    (end,) = handler.arguments
    assert end.options["target_action"] is nodes[-1]
    assert type(end.options["on_exit"][0]).__name__ == "Shutdown"
    # Arguments that are not given leave no trace.
    made = graph.options["function"](dict.fromkeys(context, ""))
    assert [node.options["parameters"] for node in _of_kind(made, "Node")] == [[]] * 4
