"""What each node is asked: one request after the other, until all have been answered."""

import time
from collections.abc import Callable, KeysView, Sequence
from functools import partial

from rclpy.node import Node

from experiment_manager.node.fault_detection import LEARNER_OF, Fault, of_refusal
from lockstep import InputError
from lockstep.exit_codes import EXIT_ROLL_BACK
from lockstep.node.requests import NOT_STARTED, Arguments, RequestClient, service_name

PLANT = "eye_plant"
LEARNERS = tuple(LEARNER_OF.values())
# A node of a user's own has no request service: a few seconds tell it from one still starting.
SERVICE_WAIT_S = 5.0
# Without episodes there is no run, so a plant is waited for longer, but not for ever.
PLANT_WAIT_S = 30.0

# Node, kind of request, arguments.
Ask = tuple[str, str, Arguments]


class Requests:
    """Asks the nodes that answer requests."""

    def __init__(
        self,
        node: Node,
        run_id: str,
        guard: Callable[[Callable[[], None]], None],
        on_fault: Callable[[Fault], None],
        welcome: Callable[[str], Sequence[Ask]],
    ) -> None:
        """guard: calls what follows an answer; on_fault: called when a request is refused.

        welcome: returns what to ask a node first that was started again and so belongs to no run,
        by its name; nothing where that is a fault.
        """
        self._node = node
        self._run_id = run_id
        self._guard = guard
        self._on_fault, self._welcome = on_fault, welcome
        self._peers = {name: RequestClient(node, name) for name in (PLANT, *LEARNERS)}
        self._since_s = time.monotonic()

    @property
    def names(self) -> KeysView[str]:
        """The nodes that are asked, as they are at any time."""
        return self._peers.keys()

    @property
    def learners(self) -> list[str]:
        """The learners that are asked."""
        return [name for name in LEARNERS if name in self._peers]

    def wait_from_now(self) -> None:
        """Give the nodes time for their request services from now on."""
        self._since_s = time.monotonic()

    def awaited(self) -> list[str]:
        """Return the nodes whose request service may still come; give up those that have none.

        Raises InputError when the plant, which is there, has none.
        """
        absent = [name for name, client in self._peers.items() if not client.is_there()]
        waited_s = time.monotonic() - self._since_s
        if absent and waited_s < SERVICE_WAIT_S:
            return absent
        if PLANT in absent:
            if waited_s < PLANT_WAIT_S:
                return absent
            raise InputError(
                f"expected a plant with the service {service_name(PLANT)}, which takes the requests"
                f" for episodes, found none in {PLANT_WAIT_S:g} s; docs/reference/topics.md lists"
                " the requests that your own plant must answer"
            )
        for name in absent:
            self._node.get_logger().warning(
                f"{name} answers no requests: the run continues without checkpoints"
            )
            del self._peers[name]
        return []

    def ask(self, asks: Sequence[Ask], then: Callable[[], None]) -> None:
        """Ask one after the other, then go on; a refusal is a fault."""
        if not asks:
            then()
            return
        (name, kind, arguments), *rest = asks

        def on_answer(successful: bool, reason: str) -> None:
            first = self._welcome(name) if reason.startswith(NOT_STARTED) else ()
            if successful:
                self._guard(partial(self.ask, rest, then))
            elif first:
                self._guard(partial(self.ask, [*first, *asks], then))
            elif reason.startswith(NOT_STARTED):
                self._on_fault(Fault(f"{name} was started again", EXIT_ROLL_BACK))
            else:
                self._on_fault(of_refusal(name, kind, reason))

        self._peers[name].ask(self._run_id, kind, arguments, on_answer)

    def ask_each(self, kind: str, then: Callable[[], None]) -> None:
        """Ask all nodes the same, without arguments, then go on."""
        self.ask([(name, kind, {}) for name in self._peers], then)
