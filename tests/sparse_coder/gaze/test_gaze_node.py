"""What the node sparse_coder says of gaze, and whom it asks where to look."""

from typing import Any

import numpy as np
import pytest
from rclpy.node import Node
from sensor_msgs.msg import JointState

from lockstep import MUSCLE_NAMES
from lockstep.wire.topics import (
    GAZE,
    GAZE_NAMES,
    GAZE_TARGET,
    GIVEN_TARGET_NAMES,
    TARGET_NAMES,
    TEST,
    TRAINING,
)
from lockstep.wire.vectors import vector_message
from sparse_coder.node import INPUTS, SparseCoderNode
from tests.learner_contract import LearnerBench
from tests.node_harness import Graph
from tests.sparse_coder.test_node import _observation

SACCADES = {
    "n_bases": 16,
    "fixation_iterations": 5,
    "command_space": "all_muscles",
    "highest_activations": (0.2,),
    "lowest_activations": (0.0,),
}
WANTED_DEG, GIVEN_DEG = (4.0, -3.0), (1.5, 2.5)


def _fixation(number: int, phase: int = TRAINING, given_deg: Any = GIVEN_DEG) -> dict[str, Any]:
    """Return the messages of an observation with which a fixation of 5 iterations begins."""
    messages = _observation(number, phase)
    episode = messages["episode"]
    values = dict(zip(episode.name, episode.position, strict=True)) | {"iteration": 5.0 * number}
    values |= dict(zip(GIVEN_TARGET_NAMES, (*given_deg, 5.0, 6.0), strict=True))
    stamp_ns = number * 10**9
    twelve = (0.1,) * len(MUSCLE_NAMES)
    messages["muscle_activations"] = vector_message(stamp_ns, MUSCLE_NAMES, twelve, effort=twelve)
    messages["episode"] = vector_message(stamp_ns, tuple(values), tuple(values.values()))
    return messages


@pytest.fixture
def bench(graph: Graph) -> LearnerBench:
    node = graph.add(SparseCoderNode, **SACCADES)
    return LearnerBench(graph, node, INPUTS, {GAZE: JointState}, _fixation)


def _target_deg(bench: LearnerBench, number: int) -> tuple[float, ...]:
    gaze = bench.wait_distinct(GAZE, number)[-1]
    assert tuple(gaze.name) == GAZE_NAMES
    assert np.isnan(gaze.position[2:-1]).all()
    assert gaze.position[-1] == 0.0
    return tuple(gaze.position[:2])


def test_a_fixation_begins_with_what_the_episode_gives(bench: LearnerBench) -> None:
    bench.show(1)
    assert _target_deg(bench, 1) == GIVEN_DEG


def test_without_it_the_eyes_choose(bench: LearnerBench) -> None:
    bench.send(_fixation(1, given_deg=(np.nan, np.nan)))
    assert np.isfinite(_target_deg(bench, 1)).all()


def _wish(graph: Graph, wanted_deg: tuple[float, float]) -> None:
    """Let somebody else want a place to be looked at."""
    person = graph.add(lambda **kwargs: Node("person", **kwargs))
    wishes = person.create_publisher(JointState, GAZE_TARGET, 1)
    graph.spin_until(wishes.get_subscription_count, "the coder's subscription")
    wishes.publish(vector_message(0, TARGET_NAMES, wanted_deg))


def test_what_somebody_wants_comes_first_once_but_not_in_tests(bench, graph) -> None:
    _wish(graph, WANTED_DEG)
    bench.show(1, TEST)
    found = [_target_deg(bench, 1)]
    # The wish and the observations take different ways.
    while WANTED_DEG not in found and len(found) < 20:
        bench.show(len(found) + 1)
        found.append(_target_deg(bench, len(found) + 1))
    bench.show(len(found) + 1)
    found.append(_target_deg(bench, len(found) + 1))
    assert found[0] == found[-1] == GIVEN_DEG
    assert found.count(WANTED_DEG) == 1


def test_a_wish_without_a_place_is_refused(bench: LearnerBench, graph: Graph) -> None:
    _wish(graph, (np.nan, 0.0))
    graph.spin_until(lambda: bench.node.diagnostics.n_refused, "a refusal")
    bench.show(1)
    assert _target_deg(bench, 1) == GIVEN_DEG
