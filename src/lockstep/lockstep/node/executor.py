"""An executor that spends little time between a message and its callback.

rclpy's own executor builds a new wait set, a coroutine and a task for each single message, about
0.2 ms in all: a loop of three hops with ten messages each feels that. This one keeps what it waits
on, and takes every message that is there after one wait.
"""

from collections.abc import Callable, Iterable
from functools import partial
from typing import Any

from rclpy.client import Client
from rclpy.executors import SingleThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.logging import get_logger
from rclpy.service import Service
from rclpy.subscription import Subscription
from rclpy.timer import Timer

_FOREVER_NS = -1
_KINDS = ("client", "service", "timer")
_LOGGER = get_logger("lockstep")
# Messages taken from one topic before others get their turn, so that a flood cannot starve them.
_MAX_IN_A_ROW = 16


class LockstepExecutor(SingleThreadedExecutor):
    """Serves messages, requests, answers and timers itself; all else goes the base class's way.

    A node may say which messages are worth waking up for: `awaited_subscriptions`, asked before
    each wait, returns them; the others are taken when something wakes it. Without it, all are.

    Callbacks must be plain functions, and nodes must not be shared with another executor. Uses
    parts of rclpy 7.1 (Jazzy) that are not public.
    """

    _stale = True

    def wake(self) -> None:
        """Note that a node's entities have changed, and end the wait."""
        self._stale = True
        super().wake()

    def spin(self) -> None:
        """Execute callbacks until shutdown."""
        while self._context.ok() and not self._is_shutdown:
            if self._stale:
                self._collect()
            self._wait()
            if self._context.ok() and not self._is_shutdown:
                self._serve()

    def _collect(self) -> None:
        self._stale = False
        nodes = self.get_nodes()
        self._subscriptions: list[Subscription] = [s for n in nodes for s in n.subscriptions]
        self._awaited: list[Callable[[], Iterable[Subscription]]] = [
            getattr(node, "awaited_subscriptions", partial(list, [*node.subscriptions]))
            for node in nodes
        ]
        self._services: list[Service] = [s for n in nodes for s in n.services]
        self._timers: list[Timer] = [t for n in nodes for t in n.timers]
        self._clients: list[Client] = [c for n in nodes for c in n.clients]
        self._guards = [*(g for n in nodes for g in n.guards), self._guard, self._sigint_gc]
        # Answers first: what they release must not wait behind a stream of messages.
        self._serving: dict[str, tuple[list[Any], Callable[[Any], None]]] = {
            "client": (self._clients, self._receive),
            "subscription": (self._subscriptions, self._take_all),
            "service": (self._services, _answer),
            "timer": (self._timers, _fire),
        }
        self._wait_set = _rclpy.WaitSet(
            len(self._subscriptions),
            len(self._guards),
            len(self._timers),
            len(self._clients),
            len(self._services),
            0,
            self._context.handle,
        )

    def _wait(self) -> None:
        wait_set = self._wait_set
        wait_set.clear_entities()
        for awaited in self._awaited:
            for subscription in awaited():
                wait_set.add_subscription(subscription.handle)
        for service in self._services:
            wait_set.add_service(service.handle)
        for timer in self._timers:
            wait_set.add_timer(timer.handle)
        for client in self._clients:
            wait_set.add_client(client.handle)
        for guard in self._guards:
            wait_set.add_guard_condition(guard.handle)
        wait_set.wait(_FOREVER_NS)

    def _serve(self) -> None:
        """Call back for what is ready; stop early when a callback has changed the entities.

        Whatever ended the wait, messages are taken from all topics, also those not waited on.
        """
        ready = {kind: set(self._wait_set.get_ready_entities(kind)) for kind in _KINDS}
        for kind, (entities, serve) in self._serving.items():
            is_ready = ready.get(kind)
            for entity in entities if is_ready or is_ready is None else ():
                if is_ready is None or entity.handle.pointer in is_ready:
                    serve(entity)
                    if self._stale or not self._context.ok():
                        return
        if ready["timer"] or self._wait_set.get_ready_entities("guard_condition"):
            # The moment to look at what is rare: QoS events, which are not waited on here.
            self.spin_once(timeout_sec=0.0)

    def _take_all(self, subscription: Subscription) -> None:
        for _ in range(_MAX_IN_A_ROW):
            taken = subscription.handle.take_message(subscription.msg_type, subscription.raw)
            if taken is None:
                return
            subscription.callback(taken[0])
            if self._stale or not self._context.ok():
                return

    def _receive(self, client: Client) -> None:
        header, response = client.handle.take_response(client.srv_type.Response)
        if header is None:
            return
        try:
            future = client.get_pending_request(header.request_id.sequence_number)
        except KeyError:
            return  # the one who asked no longer waits
        # With an executor, the future's callbacks become tasks; without, their exceptions warnings.
        future._set_executor(self)
        future.set_result(response)
        self._run_tasks()

    def _take_service(self, srv: Service) -> Any:
        """Return what answers a request that the base class comes upon."""

        async def answer() -> None:
            _answer(srv)

        return answer

    def _run_tasks(self) -> None:
        with self._tasks_lock:
            tasks = list(self._tasks)
            self._tasks.clear()
        for task, _, _ in tasks:
            task()
            task.result()  # raises what the callback raised


def _answer(service: Service) -> None:
    request, header = service.handle.service_take_request(service.srv_type.Request)
    if header is None:
        return
    try:
        response = service.callback(request, service.srv_type.Response())
    except ValueError as error:
        # rclpy's own parameter services raise it for a value of no known type: that is no reason
        # to end. There is no answer to such a request.
        _LOGGER.error(f"{service.srv_name}: {error}", throttle_duration_sec=1.0)
        return
    service.send_response(response, header)


def _fire(timer: Timer) -> None:
    if timer.handle.is_timer_ready():
        timer.handle.call_timer()
        timer.callback()
