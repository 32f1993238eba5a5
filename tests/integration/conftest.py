"""Nodes that the tests start one by one."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from tests.graph_harness import NodeProcess, small_run, write_configuration
from tests.node_harness import Graph


@pytest.fixture
def config_file(tmp_path: Path, pictures: Path) -> Path:
    """Return the configuration of a very short run, of 20 training iterations."""
    path = tmp_path / "config.yaml"
    write_configuration(path, small_run(pictures, 20))
    return path


@pytest.fixture
def start_node(graph: Graph, config_file: Path) -> Iterator[Callable[..., NodeProcess]]:
    """Return a function that starts the script of a node in the test's domain."""
    with ExitStack() as stack:

        def start(package: str, *more: str) -> NodeProcess:
            node = NodeProcess(package, graph.domain, config_file, *more)
            stack.callback(node.close)
            return node

        yield start
