"""Which executor serves a node: rclpy's own, or the faster one in `lockstep.node.fast_executor`."""

from importlib.metadata import version

from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.logging import get_logger

from lockstep.node.fast_executor import LockstepExecutor
from lockstep.plain import is_plain

# The releases for Jazzy. The fast one uses parts of rclpy that may be others in another release.
_RCLPY = "7.1."


def make_executor(context: Context | None = None) -> SingleThreadedExecutor:
    """Return rclpy's own executor, or the faster LockstepExecutor.

    rclpy's own where `lockstep.plain` asks for it and, with a warning, where rclpy is of another
    release.
    """
    if is_plain():
        return SingleThreadedExecutor(context=context)
    found = version("rclpy")
    if not found.startswith(_RCLPY):
        get_logger("lockstep").warning(
            f"expected rclpy {_RCLPY}x, got {found}: using its own executor, which is slower"
        )
        return SingleThreadedExecutor(context=context)
    return LockstepExecutor(context=context)
