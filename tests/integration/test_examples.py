"""The examples of docs/examples as they stand: each in the place of one of our nodes."""

import json
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from experiment_manager.commands.evaluate import main as evaluate
from tests.graph_harness import StartNode
from tests.node_harness import Graph
from tests.supervisor import environment, finished

EXAMPLES = Path(__file__).parents[2] / "docs" / "examples"
StartExample = Callable[[str], "subprocess.Popen[str]"]
OURS = {"plant": "eye_plant", "coder": "sparse_coder", "controller": "vergence_rl"}


@pytest.fixture
def start_example(graph: Graph) -> Iterator[StartExample]:
    """Return a function that starts an example in the test's domain."""
    with ExitStack() as stack:

        def start_example(name: str) -> "subprocess.Popen[str]":
            process = subprocess.Popen(
                [sys.executable, EXAMPLES / f"{name}.py"],
                env=environment() | {"ROS_DOMAIN_ID": str(graph.domain)},
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
            )
            stack.callback(process.communicate)
            stack.callback(process.kill)
            return process

        yield start_example


# Each has one of ours as a neighbour.
@pytest.mark.parametrize("examples", [("plant",), ("coder", "controller")])
def test_replacements_make_a_run_with_our_other_nodes(
    start_example, start, tmp_path, examples
) -> None:
    run = tmp_path / "run"
    for name, package in OURS.items():
        start_example(name) if name in examples else start(package)
    start("experiment_manager", "-p", f"run_directory:={run}").finished()
    results = json.loads((run / "results.json").read_text())
    assert [test["n_trials"] for test in results["tests"]] == [4, 4]
    assert evaluate([str(run)]) == 0


def test_a_manager_drives_our_nodes(start_example: StartExample, start: StartNode) -> None:
    for package in OURS.values():
        start(package)
    said = finished(start_example("manager")).splitlines()
    assert [line.partition(":")[0] for line in said] == [f"episode {i}" for i in range(10)]
