"""A node as a process: start, spin, stop, and one clear line when it cannot start."""

import errno
import os
import signal
import sys
from collections.abc import Callable
from types import FrameType

import rclpy
from rclpy.exceptions import NameValidationException
from rclpy.executors import ExternalShutdownException
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import remove_ros_args

from lockstep.errors import DivergenceError, InputError
from lockstep.exit_codes import EXIT_BAD_INPUT, EXIT_DIVERGED, FAULT_TEXT
from lockstep.node.cores import share_two_cores
from lockstep.node.executor import make_executor

_ROS_ERRORS = (_rclpy.RCLError, _rclpy.RCLInvalidROSArgsError, _rclpy.UnknownROSArgsError)
# How ROS words that the system is short of threads or memory: no fault of what the node was given.
_SHORTAGES = tuple(os.strerror(code) for code in (errno.EAGAIN, errno.ENOMEM))


def run_node(make_node: Callable[[], Node], arguments: list[str] | None = None) -> int:
    """Spin the node until it is told to stop; return the exit code of the process.

    Where there are two cores, the process keeps to that of the node's `core_of_two`, 0 or 1, and
    does not interrupt others there if the node `gives_way`; see lockstep.node.cores.
    SIGTERM ends the process; so does SIGINT, unless the node has an `interrupt` to call instead.
    The code is the node's `exit_code` if it has one, else 0; it is 2 when the node cannot start
    because of what it was given, and 6 when what it learns diverges: then the reason is the last
    line on standard error. Raises the error of a node that cannot start for want of threads or
    memory: another attempt may find them.
    """
    try:
        unknown = remove_ros_args(arguments)[0 if arguments is not None else 1 :]
        if unknown:
            raise InputError(
                f"unknown argument {' '.join(unknown)}: expected --ros-args, and after it such as "
                "-p NAME:=VALUE or --params-file FILE"
            )
        rclpy.init(args=arguments, signal_handler_options=SignalHandlerOptions.NO)
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        return EXIT_BAD_INPUT
    except _ROS_ERRORS as error:
        print(f"error: expected ROS arguments: {_in_one_line(error)}", file=sys.stderr)
        return EXIT_BAD_INPUT
    try:
        node = make_node()
    except (InputError, NameValidationException, *_ROS_ERRORS) as error:
        rclpy.try_shutdown()
        if any(shortage in str(error) for shortage in _SHORTAGES):
            raise
        print(f"error: {_in_one_line(error)}", file=sys.stderr)
        return EXIT_BAD_INPUT

    share_two_cores(getattr(node, "core_of_two", 0), gives_way=getattr(node, "gives_way", False))

    def on_signal(number: int, frame: FrameType | None) -> None:
        # Python runs this between two bytecodes: the 1 Hz diagnostics wake an idle executor.
        interrupt = getattr(node, "interrupt", None)
        if number == signal.SIGINT and interrupt is not None:
            interrupt()
        else:
            rclpy.try_shutdown()

    signal.signal(signal.SIGINT, on_signal)
    signal.signal(signal.SIGTERM, on_signal)
    executor = make_executor()
    executor.add_node(node)
    try:
        executor.spin()
    except ExternalShutdownException:
        pass
    except DivergenceError as error:
        print(f"{FAULT_TEXT}{_in_one_line(error)}", file=sys.stderr)
        return EXIT_DIVERGED
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
    return int(getattr(node, "exit_code", 0))


def _in_one_line(error: Exception) -> str:
    return " ".join(str(error).split())
