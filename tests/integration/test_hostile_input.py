"""Hostile input: what `torture.sh --inputs` throws, and a second publisher."""

from pathlib import Path

from rclpy.node import Node

from experiment_manager.hostility import Hostility
from lockstep.topics import REWARD_NAMES
from lockstep.vectors import VectorPublisher
from tests.graph_harness import finished, small_run, supervisor
from tests.node_harness import ros_graph

SMALL_LEARNERS = ("sparse_coder.n_bases=32", "vergence_rl.n_features=64")


def test_what_is_thrown_is_a_function_of_the_seed() -> None:
    def thrown(seed: int) -> list[tuple[str, int, int]]:
        hostility = Hostility(seed, 10**8)
        messages = (hostility.message(10**9) for _ in range(200))
        return [(topic, m.header.stamp.sec, m.header.stamp.nanosec) for topic, m in messages]

    assert thrown(1) == thrown(1) != thrown(2)
    assert len({topic for topic, _, _ in thrown(1)}) == 7


def test_a_second_publisher_ends_the_run_with_one_error(tmp_path: Path, pictures: Path) -> None:
    with ros_graph() as graph:
        somebody = graph.add(lambda **kwargs: Node("somebody", **kwargs))
        VectorPublisher(somebody, "reward", REWARD_NAMES)
        run = supervisor(
            [*small_run(pictures, 200, *SMALL_LEARNERS), "--out", str(tmp_path / "run")],
            ROS_DOMAIN_ID=str(graph.domain),
        )
        output = finished(run, code=3)
    fault = "experiment_manager ended: expected one publisher per topic, found more on reward"
    assert output.count(f"fault: {fault}") == 3
    assert output.count("error: ") == 1
    assert f"the same fault 3 times after episode 0: {fault}" in output
