"""A node as a process: start, spin, stop, and one clear line when it cannot start."""

import signal
import sys
from collections.abc import Callable

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node

from lockstep.errors import InputError

EXIT_BAD_INPUT = 2


def run_node(make_node: Callable[[], Node], arguments: list[str] | None = None) -> int:
    """Spin the node until it is told to stop; return the exit code of the process.

    0 after Ctrl-C or SIGTERM, 2 when the node cannot start because of what it was given; then the
    reason is the last line on standard error.
    """
    rclpy.init(args=arguments)
    try:
        node = make_node()
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        rclpy.try_shutdown()
        return EXIT_BAD_INPUT
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        # A second Ctrl-C must not leave a node half destroyed.
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        node.destroy_node()
        rclpy.try_shutdown()
    return int(getattr(node, "exit_code", 0))
