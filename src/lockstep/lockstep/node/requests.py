"""Requests between nodes, over rcl_interfaces/srv/SetParametersAtomically.

A request is a set of named values: `run_id`, `request` (its kind) and its arguments. It either
takes effect as a whole or is refused with the reason. The same request again is acknowledged again
without a second effect, except `start_run`, whose effect twice is that of once; another run's is
refused. So a requester may repeat itself until it hears an answer.
"""

from collections.abc import Callable, Mapping
from typing import Any

from rcl_interfaces.msg import SetParametersResult
from rcl_interfaces.srv import SetParametersAtomically
from rclpy.client import Client
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.parameter import Parameter

from lockstep.errors import InputError
from lockstep.node.diagnostics import Diagnostics

SERVICE = "request"
START_RUN = "start_run"
END_RUN = "end_run"
# Of the plant: its arguments are settings that hold from the next episode on.
RECONFIGURE = "reconfigure"
# How a node that belongs to no run refuses whatever else it is asked.
NOT_STARTED = f"expected {START_RUN} first"

Arguments = dict[str, Any]
Handler = Callable[[Arguments], None]


def service_name(node_name: str) -> str:
    """Return the name of a node's request service, relative to the namespace."""
    return f"{node_name}/{SERVICE}"


class RequestServer:
    """Answers the requests of the one run that the node belongs to.

    The node belongs to the first run that asks for `start_run`, until that run's `end_run`; both
    are kinds of every node, without arguments. `start_run` of the same run starts it again: so does
    a resume.
    """

    def __init__(
        self,
        node: Node,
        diagnostics: Diagnostics,
        handlers: Mapping[str, Handler],
        name: str = "",
    ) -> None:
        """handlers: by kind; a handler raises InputError to refuse, having changed nothing.

        name: of the node in whose place it answers, "" for its own.
        """
        self._diagnostics = diagnostics
        self._handlers = handlers
        self._run_id = ""
        self._last_accepted = ""
        node.create_service(
            SetParametersAtomically, service_name(name or node.get_name()), self._answer
        )

    def _answer(
        self, request: SetParametersAtomically.Request, response: SetParametersAtomically.Response
    ) -> SetParametersAtomically.Response:
        try:
            self._handle(_arguments_of(request))
            response.result = SetParametersResult(successful=True)
        except InputError as error:
            self._diagnostics.refuse(f"request: {error}")
            response.result = SetParametersResult(successful=False, reason=str(error))
        except ValueError as error:
            # Not of the request's making; the executor would take it for one.
            raise RuntimeError(f"an error in the handling of a request: {error}") from error
        return response

    def _handle(self, arguments: Arguments) -> None:
        # As text, since True == 1 == 1.0 in Python.
        text = repr(arguments)
        # `start_run` takes effect each time: its requester may have restarted too.
        if text == self._last_accepted and arguments["request"] != START_RUN:
            return
        kind, run_id = arguments.get("request"), arguments.get("run_id")
        if not isinstance(run_id, str) or not run_id:
            raise InputError(f"run_id: expected the name of a run, got {run_id!r}")
        if not isinstance(kind, str) or kind not in self._handlers:
            raise InputError(
                f"kind of request: expected {', '.join(sorted(self._handlers))}, got {kind!r}"
            )
        if self._run_id and run_id != self._run_id:
            raise InputError(f"expected a request of run {self._run_id}, got one of run {run_id}")
        if not self._run_id and kind != START_RUN:
            raise InputError(f"{NOT_STARTED}, got {kind} of run {run_id}")
        values = {k: v for k, v in arguments.items() if k not in ("run_id", "request")}
        if values and kind in (START_RUN, END_RUN):
            raise InputError(f"{kind}: expected no arguments, got {', '.join(values)}")
        self._handlers[kind](values)
        self._run_id = "" if kind == END_RUN else run_id
        self._last_accepted = text


def _arguments_of(request: SetParametersAtomically.Request) -> Arguments:
    arguments: Arguments = {}
    for message in request.parameters:
        try:
            parameter = Parameter.from_parameter_msg(message)
        except (ValueError, TypeError, AssertionError, AttributeError) as error:
            raise InputError(f"expected named values, got {message}: {error}") from error
        value = parameter.value
        is_list = not isinstance(value, str | bytes) and hasattr(value, "__iter__")
        if parameter.name in arguments:
            raise InputError(f"expected each name once, got {parameter.name} twice")
        arguments[parameter.name] = list(value) if is_list else value
    return arguments


class RequestClient:
    """Asks one node, and repeats the request until an answer comes.

    One request is under way at a time. `on_answer(successful, reason)` is called once for each.
    """

    # Long against the slowest answer (a state of some MB written to disk), short for a person.
    REPEAT_AFTER_S = 2.0

    def __init__(self, node: Node, node_name: str) -> None:
        """node_name: whom to ask."""
        self.node_name = node_name
        self._node = node
        self._client: Client = node.create_client(SetParametersAtomically, service_name(node_name))
        self._request: SetParametersAtomically.Request | None = None
        self._on_answer: Callable[[bool, str], None]
        self._timer = node.create_timer(
            self.REPEAT_AFTER_S,
            self._send,
            clock=Clock(clock_type=ClockType.STEADY_TIME),
            autostart=False,
        )

    def is_there(self) -> bool:
        """Return whether the node answers requests at all (a foreign one need not)."""
        return bool(self._client.service_is_ready())

    def ask(
        self, run_id: str, kind: str, arguments: Arguments, on_answer: Callable[[bool, str], None]
    ) -> None:
        """Send a request; raise RuntimeError while another is under way."""
        if self._request is not None:
            raise RuntimeError(f"{self.node_name}: the last request has no answer yet")
        values = {"run_id": run_id, "request": kind} | arguments
        self._request = SetParametersAtomically.Request(
            parameters=[Parameter(name, value=v).to_parameter_msg() for name, v in values.items()]
        )
        self._on_answer = on_answer
        self._send()
        self._timer.reset()

    def _send(self) -> None:
        request = self._request
        if request is None:
            return
        future = self._client.call_async(request)
        future.add_done_callback(lambda done: self._receive(request, done.result()))

    def _receive(
        self,
        request: SetParametersAtomically.Request,
        response: SetParametersAtomically.Response | None,
    ) -> None:
        # The answer to a repeat of an earlier request says nothing about this one.
        if response is None or request is not self._request:
            return
        self._timer.cancel()
        self._request = None
        self._on_answer(response.result.successful, response.result.reason)
