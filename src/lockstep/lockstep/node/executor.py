"""Which executor serves a node: rclpy's own, or the faster one in `lockstep.node.fast_executor`."""

from typing import Any

from rclpy.client import Client
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.logging import get_logger
from rclpy.node import Node
from rclpy.task import Future

from lockstep.node.fast_executor import LockstepExecutor
from lockstep.plain import is_plain

_LOGGER = get_logger("lockstep")

# What the fast one uses of rclpy and may be another in another version, by its owner.
_PRIVATE_NAMES: dict[Any, tuple[str, ...]] = {
    _rclpy: ("WaitSet", "Subscription", "Client", "Service", "Timer"),
    SingleThreadedExecutor: ("_take_service", "wake"),
    Client: ("get_pending_request",),
    Future: ("_set_executor",),
    Node: ("guards", "subscriptions", "clients", "services", "timers"),
}
_HANDLE_NAMES = {
    "WaitSet": (
        "add_client",
        "add_guard_condition",
        "add_service",
        "add_subscription",
        "add_timer",
        "clear_entities",
        "get_ready_entities",
        "wait",
    ),
    "Subscription": ("take_message",),
    "Client": ("take_response",),
    "Service": ("service_take_request",),
    "Timer": ("call_timer", "is_timer_ready"),
}
_EXECUTOR_ATTRIBUTES = ("_context", "_guard", "_is_shutdown", "_sigint_gc", "_tasks", "_tasks_lock")


def make_executor(context: Context | None = None) -> SingleThreadedExecutor:
    """Return rclpy's own executor, or the faster LockstepExecutor.

    rclpy's own where `lockstep.plain` asks for it and, with a warning, where rclpy has changed
    inside.
    """
    executor = SingleThreadedExecutor(context=context)
    if is_plain():
        return executor
    missing = _missing_names(executor)
    if missing:
        _LOGGER.warning(
            f"expected rclpy to have {', '.join(missing)}, as in its version 7.1: using its"
            " own executor, which is slower"
        )
        return executor
    executor.shutdown()
    return LockstepExecutor(context=context)


def _missing_names(executor: SingleThreadedExecutor) -> list[str]:
    """Return the names of rclpy that are used here and that this rclpy does not have."""
    owners = [
        *_PRIVATE_NAMES.items(),
        *((getattr(_rclpy, kind, None), names) for kind, names in _HANDLE_NAMES.items()),
        (executor, _EXECUTOR_ATTRIBUTES),
    ]
    return [
        f"{getattr(owner, '__name__', type(owner).__name__)}.{name}"
        for owner, names in owners
        for name in names
        if not hasattr(owner, name)
    ]
