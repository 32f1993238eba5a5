"""What is recorded of an episode."""

from functools import partial

import pytest
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.node import Node
from sensor_msgs.msg import Image, JointState

from experiment_manager import Bag, ExperimentManagerConfig
from experiment_manager.node.recorder import Recorder
from experiment_manager.run.run_directory import Run
from lockstep.wire.stamps import NS_PER_S, period_ns
from lockstep.wire.topics import reward_names
from lockstep.wire.vectors import vector_message
from tests.node_harness import Graph, Outsider
from tests.patience import PATIENCE_S


@pytest.fixture
def node(graph: Graph) -> Node:
    """Return a node that does nothing by itself."""
    found: Node = graph.add(partial(Node, "records"))
    return found


@pytest.fixture
def learner(graph: Graph) -> Outsider:
    """Return who answers."""
    found: Outsider = graph.add(partial(Outsider, {"reward": JointState, "features": Image}, {}))
    return found


def _has_come(node: Node, topic: str, within_s: float = PATIENCE_S) -> bool:
    """Wait for a message, and leave it where it is."""
    (subscription,) = (s for s in node.subscriptions if s.topic_name == f"/{topic}")
    wait_set = _rclpy.WaitSet(1, 0, 0, 0, 0, 0, node.context.handle)
    wait_set.add_subscription(subscription.handle)
    wait_set.wait(int(within_s * NS_PER_S))
    return bool(wait_set.get_ready_entities("subscription"))


def test_answers_from_before_the_first_episode_are_not_recorded(
    graph, node, learner, tmp_path
) -> None:
    config = ExperimentManagerConfig(run_directory=str(tmp_path / "run"))
    run = Run(config)
    recorder = Recorder(node, run, config, lambda act: act(), lambda: None)
    recorder.sample_pictures()
    graph.spin_until(learner.is_matched, "the recorder to listen")
    episode = run.episode()
    first_ns = episode.first_observation * period_ns(config.mechanics.period_s)

    def answer(value: float) -> None:
        learner.send(
            "reward", vector_message(first_ns, reward_names(), [value] * len(reward_names()))
        )
        assert _has_come(node, "reward")

    # Of a learner that does not know yet from where the run goes on.
    answer(1.0)
    learner.send("features", Image())
    assert _has_come(node, "features")
    recorder.begin(episode)
    assert not _has_come(node, "features", within_s=0.0)
    answer(2.0)
    record = recorder.record
    left = f"{episode.n_iterations - 1} of reward"
    graph.spin_until(lambda: record is not None and left in record.missing(), "the answer")
    recorder.close()
    run.close()
    (values,) = Bag(tmp_path / "run" / "bag").vectors("reward")["reward"].position
    assert values.tolist() == [2.0] * len(reward_names())
