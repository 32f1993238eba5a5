"""A node as a process: start, spin, stop, and one clear line when it cannot start."""

import signal
import sys
from collections.abc import Callable
from types import FrameType

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from lockstep.errors import InputError
from lockstep.executor import LockstepExecutor

EXIT_BAD_INPUT = 2


def run_node(make_node: Callable[[], Node], arguments: list[str] | None = None) -> int:
    """Spin the node until it is told to stop; return the exit code of the process.

    SIGINT and SIGTERM call the node's `interrupt` if it has one, and end the process otherwise.
    The code is the node's `exit_code` if it has one, else 0; it is 2 when the node cannot start
    because of what it was given: then the reason is the last line on standard error.
    """
    rclpy.init(args=arguments, signal_handler_options=SignalHandlerOptions.NO)
    try:
        node = make_node()
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        rclpy.try_shutdown()
        return EXIT_BAD_INPUT

    def on_signal(number: int, frame: FrameType | None) -> None:
        # Python runs this between two bytecodes: the 1 Hz diagnostics wake an idle executor.
        getattr(node, "interrupt", rclpy.try_shutdown)()

    signal.signal(signal.SIGINT, on_signal)
    signal.signal(signal.SIGTERM, on_signal)
    executor = LockstepExecutor()
    executor.add_node(node)
    try:
        executor.spin()
    except ExternalShutdownException:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
    return int(getattr(node, "exit_code", 0))
