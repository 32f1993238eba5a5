"""docs/reference/topics.md against the code: names, requests, times."""

import re
from functools import partial

from rclpy.qos import DurabilityPolicy, HistoryPolicy, ReliabilityPolicy

from experiment_manager.node.requests import PLANT_WAIT_S, SERVICE_WAIT_S
from lockstep.node.requests import END_RUN, RECONFIGURE, START_RUN, RequestClient
from lockstep.wire import topics
from lockstep.wire.qos import LOCKSTEP_QOS, QUEUE_DEPTH
from tests.interfaces_page import PAGE, quoted, table
from tests.node_harness import Outsider, ros_graph
from vergence_rl.node import VergenceRlNode


def test_the_quality_of_service() -> None:
    assert f"reliable, volatile, keep last {QUEUE_DEPTH};" in PAGE
    assert LOCKSTEP_QOS.reliability == ReliabilityPolicy.RELIABLE
    assert LOCKSTEP_QOS.durability == DurabilityPolicy.VOLATILE
    assert LOCKSTEP_QOS.history == HistoryPolicy.KEEP_LAST
    # A trial is 21 observations, and a waiting plant repeats one of them each second.
    assert LOCKSTEP_QOS.depth == QUEUE_DEPTH >= 2 * 21


def test_the_vectors_of_gaze() -> None:
    names = {"episode": topics.GIVEN_TARGET_NAMES, topics.GAZE: topics.GAZE_NAMES}
    found: dict[str, list[str]] = {}
    for row in table("Gaze"):
        topic = (quoted(row[0]) or [topics.GAZE])[0]
        found.setdefault(topic, []).extend(quoted(row[1]))
    expected = names | {topics.GAZE_TARGET: topics.TARGET_NAMES}
    assert found == {topic: list(of_topic) for topic, of_topic in expected.items()}


def test_every_kind_of_request() -> None:
    kinds = [kind for row in table("Requests") for kind in quoted(row[0])]
    with ros_graph() as graph:
        graph.add(VergenceRlNode)
        outsider = graph.add(partial(Outsider, {}, {}))
        graph.spin_until(lambda: outsider.has_service("vergence_rl"), "the learner's service")
        answer = outsider.future_answer("vergence_rl", {"run_id": "a run", "request": "?"})
        graph.spin_until(answer.done, "a refusal")
    expected = re.search("kind of request: expected (.*), got '\\?'", answer.result().result.reason)
    assert expected is not None
    of_learners = expected[1].split(", ")
    assert set(kinds) == {"episode", RECONFIGURE, *of_learners}
    assert {START_RUN, END_RUN} < set(kinds)


def test_the_times() -> None:
    assert f"every {RequestClient.REPEAT_AFTER_S:g} s until it is answered" in PAGE
    assert f"the manager stops after {PLANT_WAIT_S:g} s" in PAGE
    assert f"The manager waits {SERVICE_WAIT_S:g} s for a coder or controller" in PAGE
