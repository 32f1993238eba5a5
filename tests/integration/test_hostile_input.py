"""Hostile input: thousands of malformed messages and requests leave no trace in the numbers."""

from pathlib import Path

import pytest

from experiment_manager.nodes import MOVABLE_NODES
from tests.graph_harness import small_run, write_configuration
from tools.stress.fuzzer import Hostility
from tools.stress.hostile_input import BOUND_MB, fuzzed

pytestmark = pytest.mark.graph

SMALL_LEARNERS = ("task.n_bases=32",)


def test_two_thousand_hostile_inputs_change_nothing(tmp_path: Path, pictures: Path) -> None:
    config_file = tmp_path / "config.yaml"
    write_configuration(
        config_file,
        small_run(pictures, 100, *SMALL_LEARNERS, "experiment_manager.test_distances_m=[6.0]"),
    )
    # One trial, which is not learned from, and 9 episodes of training: 120 observations.
    report = fuzzed(config_file, 1, 10, 17, tmp_path)
    assert report.differences == []
    assert report.n_inputs >= 2000
    # Ground truth, thoughts, dictionaries and weights.
    assert report.n_compared > 10_000
    # Of messages with another stamp most are passed over in silence; requests never are.
    assert report.n_refused > 100
    assert set(report.growth_mb) == set(MOVABLE_NODES)
    # What the middleware's queues keep, and nothing that grows with the number of inputs.
    assert max(report.growth_mb.values()) < BOUND_MB


def test_what_is_thrown_is_a_function_of_the_seed() -> None:
    def thrown(seed: int) -> list[tuple[str, int, int]]:
        hostility = Hostility(seed, 10**8)
        messages = (hostility.message(10**9) for _ in range(200))
        return [(topic, m.header.stamp.sec, m.header.stamp.nanosec) for topic, m in messages]

    assert thrown(1) == thrown(1) != thrown(2)
    assert len({topic for topic, _, _ in thrown(1)}) == 7
