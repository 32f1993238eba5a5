"""What tests of nodes that somebody starts one by one share."""

from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from tests.graph_harness import NodeProcess, StartNode, small_run, write_configuration
from tests.node_harness import Graph


@pytest.fixture
def config_file(tmp_path: Path, pictures: Path) -> Path:
    """Return the configuration of a run of 20 iterations between two tests of 4 trials."""
    path = tmp_path / "config.yaml"
    write_configuration(path, small_run(pictures, 20))
    return path


@pytest.fixture
def start(graph: Graph, config_file: Path) -> Iterator[StartNode]:
    """Return a function that starts the script of a node in the test's domain."""
    with ExitStack() as stack:

        def start(package: str, *more: str) -> NodeProcess:
            node = NodeProcess(package, graph.domain, config_file, *more)
            stack.callback(node.close)
            return node

        yield start
