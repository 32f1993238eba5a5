"""The examples of docs/examples as they stand: each in the place of one of our nodes."""

import json
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest
from rclpy.node import Node
from sensor_msgs.msg import JointState

from active_binocular_vision.commands.evaluate import main as evaluate
from lockstep.wire.topics import GAZE_TARGET, TARGET_NAMES
from tests.eye_plant.opengl import need_opengl
from tests.node_harness import Graph
from tests.supervisor import finished, started

EXAMPLES = Path(__file__).parents[2] / "docs" / "examples"
OURS = {"head": "eye_plant", "coder": "sparse_coder", "controller": "vergence_rl"}
# What the other nodes must be told of the head.
OF_HEAD = ("-p", "command_space:=pan_tilt_vergence", "-p", "mechanics.baseline_m:=0.07")
Start = Callable[[str], "subprocess.Popen[str]"]


@pytest.fixture
def start(graph: Graph) -> Iterator[Start]:
    """Return a function that starts an example in the test's domain."""
    with ExitStack() as stack:

        def start(name: str) -> "subprocess.Popen[str]":
            process = started(
                [sys.executable, EXAMPLES / f"{name}.py"],
                {"ROS_DOMAIN_ID": str(graph.domain), "MUJOCO_GL": "egl"},
            )
            stack.callback(process.communicate)
            stack.callback(process.kill)
            return process

        yield start


@pytest.mark.graph
@pytest.mark.parametrize("example", OURS)
def test_a_replacement_makes_a_run_with_our_other_nodes(
    start, start_node, tmp_path, example
) -> None:
    run, more = tmp_path / "run", OF_HEAD if example == "head" else ()
    if example == "head":
        need_opengl()
    start(example)
    for name, package in OURS.items():
        if name != example:
            start_node(package, *more)
    start_node("experiment_manager", "-p", f"run_directory:={run}", *more).finished()
    results = json.loads((run / "results.json").read_text())
    # Cameras farther apart than the eyes may begin with one more whole degree of error.
    n_trials = 5 if example == "head" else 4
    assert [test["n_trials"] for test in results["tests"]] == [n_trials, n_trials]
    assert evaluate([str(run)]) == 0


def test_a_manager_drives_our_nodes(start: Start, start_node) -> None:
    for package in OURS.values():
        start_node(package)
    said = finished(start("manager")).splitlines()
    assert [line.partition(":")[0] for line in said] == [f"episode {i}" for i in range(10)]


def test_somebody_says_where_to_look(start: Start, graph: Graph) -> None:
    listener = graph.add(lambda **kwargs: Node("listener", **kwargs))
    heard: list[JointState] = []
    listener.create_subscription(JointState, GAZE_TARGET, heard.append, 10)
    start("look")
    graph.spin_until(lambda: len(heard) >= 2, "two gaze targets")
    assert tuple(heard[0].name) == TARGET_NAMES
    assert heard[0].position != heard[1].position
