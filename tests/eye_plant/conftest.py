"""What the tests of the plant's node share."""

from pathlib import Path

import pytest

from tests.eye_plant.plant_bench import plant_bench
from tests.node_harness import Bench, Graph


@pytest.fixture
def bench(graph: Graph, pictures: Path) -> Bench:
    """Return a plant with small stimuli whose run has started."""
    bench = plant_bench(graph, pictures)
    assert bench.request("start_run") == (True, "")
    return bench
