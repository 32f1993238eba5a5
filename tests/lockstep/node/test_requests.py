"""Requests between real nodes: done once, acknowledged again, refused with the reason."""

from typing import Any

import pytest
from rcl_interfaces.msg import Parameter as ParameterMessage
from rcl_interfaces.msg import ParameterValue
from rcl_interfaces.srv import SetParametersAtomically
from rclpy.node import Node

from lockstep import InputError
from lockstep.node.diagnostics import Diagnostics
from lockstep.node.requests import END_RUN, START_RUN, RequestClient, RequestServer, service_name
from tests.node_harness import Bench, Graph


class Servant(Node):
    """Notes what was asked of it; refuses "work" with a negative load."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("servant", **kwargs)
        self.done: list[tuple[str, dict[str, Any]]] = []
        self.diagnostics = Diagnostics(self)
        kinds = (START_RUN, "work", END_RUN)
        RequestServer(self, self.diagnostics, {kind: self._handler(kind) for kind in kinds})

    def _handler(self, kind: str) -> Any:
        def handle(arguments: dict[str, Any]) -> None:
            if arguments.get("load", 0) < 0:
                raise InputError(f"load: expected 0 or more, got {arguments['load']}")
            self.done.append((kind, arguments))

        return handle


@pytest.fixture
def servant(graph: Graph) -> Servant:
    """Return a node with requests."""
    node: Servant = graph.add(Servant)
    return node


@pytest.fixture
def bench(graph: Graph, servant: Servant) -> Bench:
    """Return the servant with somebody who asks."""
    return Bench(graph, servant, {}, {})


def test_values_arrive_as_they_were(servant: Servant, bench: Bench) -> None:
    bench.request(START_RUN)
    values: dict[str, Any] = {
        "load": 3,
        "x": 0.1,
        "name": "ü",
        "yes": True,
        "list": [1.5, 2.5],
        "names": ["a"],
    }
    assert bench.request("work", **values) == (True, "")
    assert servant.done[-1] == ("work", values)


def test_the_same_request_again_is_acknowledged_and_done_once(servant, bench) -> None:
    bench.request(START_RUN)
    for _ in range(3):
        assert bench.request("work", load=1) == (True, "")
    assert servant.done == [(START_RUN, {}), ("work", {"load": 1})]
    assert bench.request("work", load=2) == (True, "")
    assert bench.request("work", load=1) == (True, "")
    assert len(servant.done) == 4


def test_a_run_begins_anew_however_often_it_is_asked_for(servant: Servant, bench: Bench) -> None:
    for _ in range(2):
        assert bench.request(START_RUN) == (True, "")
    assert servant.done == [(START_RUN, {})] * 2


def test_another_run_is_refused_until_the_first_one_ends(servant: Servant, bench: Bench) -> None:
    bench.request(START_RUN)
    reason = f"expected a request of run {bench.RUN}, got one of run other"
    for kind in (START_RUN, "work", END_RUN):
        assert bench.request(kind, run_id="other") == (False, reason)
    assert servant.done == [(START_RUN, {})]
    assert bench.request(END_RUN)[0]
    assert bench.request(START_RUN, run_id="other")[0]


def test_a_run_must_be_started_first(servant: Servant, bench: Bench) -> None:
    for kind in ("work", END_RUN):
        successful, reason = bench.request(kind)
        assert not successful
        assert reason == f"expected start_run first, got {kind} of run {bench.RUN}"
    assert servant.done == []


def test_a_refusal_tells_why_counts_and_changes_nothing(servant: Servant, bench: Bench) -> None:
    bench.request(START_RUN)
    assert bench.request("work", load=-1) == (False, "load: expected 0 or more, got -1")
    assert bench.wait_refused(1) == "request: load: expected 0 or more, got -1"
    assert servant.done == [(START_RUN, {})]


@pytest.mark.parametrize(
    ("values", "reason"),
    [
        ({}, "run_id: expected the name of a run, got None"),
        ({"request": START_RUN}, "run_id: expected the name of a run, got None"),
        ({"request": START_RUN, "run_id": ""}, "run_id: expected the name of a run, got ''"),
        ({"request": START_RUN, "run_id": 3}, "run_id: expected the name of a run, got 3"),
        ({"run_id": "a"}, "kind of request: expected end_run, start_run, work, got None"),
        ({"run_id": "a", "request": "dance"}, "expected end_run, start_run, work, got 'dance'"),
        ({"run_id": "a", "request": [1.0]}, "expected end_run, start_run, work, got [1.0]"),
        ({"run_id": "a", "request": START_RUN, "x": 2}, "start_run: expected no arguments, got x"),
    ],
)
def test_requests_without_sense(servant, bench, values, reason) -> None:
    successful, got = bench.request_raw(values)
    assert not successful
    assert got.endswith(reason)
    assert servant.done == []


def test_malformed_parameters_are_refused(graph: Graph, servant: Servant, bench: Bench) -> None:
    client = bench.outsider.create_client(SetParametersAtomically, service_name("servant"))
    text = ParameterValue(type=4, string_value=START_RUN)
    bad = [
        [ParameterMessage(name="x", value=ParameterValue(type=250))],
        [ParameterMessage(name="", value=text)],
        [
            ParameterMessage(name="request", value=text),
            ParameterMessage(name="request", value=text),
        ],
        [ParameterMessage(name="request", value=ParameterValue(type=0))],
    ]
    for parameters in bad:
        future = client.call_async(SetParametersAtomically.Request(parameters=parameters))
        graph.spin_until(future.done, "the answer")
        assert not future.result().result.successful
        assert "expected" in future.result().result.reason
    assert bench.wait_refused(len(bad))
    assert servant.done == []


def test_the_client_repeats_itself_until_somebody_answers(graph: Graph, monkeypatch) -> None:
    monkeypatch.setattr(RequestClient, "REPEAT_AFTER_S", 0.05)
    asker = graph.add(lambda **kwargs: Node("asker", **kwargs))
    client = RequestClient(asker, "servant")
    answers: list[tuple[bool, str]] = []
    client.ask("a", START_RUN, {}, lambda *answer: answers.append(answer))
    with pytest.raises(RuntimeError, match="servant: the last request has no answer yet"):
        client.ask("a", START_RUN, {}, lambda *answer: None)
    assert not client.is_there()
    servant = graph.add(Servant)
    graph.spin_until(lambda: answers, "an answer to a repeat")
    assert answers == [(True, "")]
    assert servant.done == [(START_RUN, {})]
    client.ask("a", "work", {"load": -1}, lambda *answer: answers.append(answer))
    graph.spin_until(lambda: len(answers) > 1, "the second answer")
    assert answers[1] == (False, "load: expected 0 or more, got -1")
