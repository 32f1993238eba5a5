"""What the tests of the plant's node share."""

from pathlib import Path

import pytest
from sensor_msgs.msg import JointState

from eye_plant.node.plant_node import EyePlantNode
from tests.eye_plant.plant_bench import HEARD
from tests.node_harness import Bench, Graph


@pytest.fixture
def bench(graph: Graph, pictures: Path) -> Bench:
    """Return a plant with small stimuli whose run has started."""
    plant = graph.add(EyePlantNode, stimuli__directory=str(pictures), stimuli__size_px=64)
    bench = Bench(graph, plant, {"muscle_command": JointState}, HEARD)
    assert bench.request("start_run") == (True, "")
    return bench
