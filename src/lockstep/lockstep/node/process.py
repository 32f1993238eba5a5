"""A node as a process: start, spin, stop, and one clear line when it cannot start."""

import os
import signal
import sys
from collections.abc import Callable, Sequence
from types import FrameType

import rclpy
from rclpy.exceptions import NameValidationException, ParameterException
from rclpy.executors import ExternalShutdownException
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import remove_ros_args

from lockstep.errors import DivergenceError, InputError
from lockstep.exit_codes import EXIT_BAD_INPUT, EXIT_DIVERGED, FAULT_TEXT
from lockstep.machine.cores import share_two_cores
from lockstep.machine.domain import enter_environment
from lockstep.node.executor import LockstepExecutor
from lockstep.node.parameter_files import check_arguments

# Bad input, by phase: what reading the arguments raises, and names and parameters of the node.
_OF_ARGUMENTS = (InputError, _rclpy.RCLInvalidROSArgsError, _rclpy.UnknownROSArgsError)
_OF_NAMES_AND_PARAMETERS = (InputError, NameValidationException, ParameterException)


def with_log_files_where_asked(arguments: Sequence[str]) -> list[str]:
    """Return arguments with which ROS writes log files into ROS_LOG_DIR, or none without it.

    Else it would write a copy of what is printed into the home, and fail where it cannot.
    """
    none = [] if os.environ.get("ROS_LOG_DIR") else ["--ros-args", "--disable-external-lib-logs"]
    return [*none, "--", *arguments]


def run_node(make_node: Callable[[], Node], arguments: list[str] | None = None) -> int:
    """Spin the node until it is told to stop; return the exit code of the process.

    Where there are two cores, the process keeps to that of the node's `core_of_two`, 0 or 1, and
    does not interrupt others there if the node `gives_way`; see lockstep.machine.cores.
    SIGTERM ends the process; so does SIGINT, unless the node has an `interrupt` to call instead.
    The code is the node's `exit_code` if it has one, else 0; it is 2 when the arguments, or the
    node's names and parameters, cannot be read, and 6 when what it learns diverges: then the reason
    is the last line on standard error. Raises whatever else keeps the node from starting, such as a
    shortage of memory or threads, however it is worded: another attempt may succeed.
    """
    try:
        _read_arguments(arguments)
    except _OF_ARGUMENTS as error:
        return _refused(error)
    words = with_log_files_where_asked(sys.argv if arguments is None else arguments)
    try:
        rclpy.init(args=words, signal_handler_options=SignalHandlerOptions.NO)
        node = make_node()
    except BaseException as error:
        rclpy.try_shutdown()
        if isinstance(error, _OF_NAMES_AND_PARAMETERS):
            return _refused(error)
        raise
    share_two_cores(getattr(node, "core_of_two", 0), gives_way=getattr(node, "gives_way", False))
    _listen_to_signals(node)
    return _spin(node)


def _listen_to_signals(node: Node) -> None:
    def on_signal(number: int, frame: FrameType | None) -> None:
        # Python runs this between two bytecodes: the 1 Hz diagnostics wake an idle executor.
        interrupt = getattr(node, "interrupt", None)
        if number == signal.SIGINT and interrupt is not None:
            interrupt()
        else:
            rclpy.try_shutdown()

    signal.signal(signal.SIGINT, on_signal)
    signal.signal(signal.SIGTERM, on_signal)


def _spin(node: Node) -> int:
    """Serve the node until it ends, and destroy it; return its exit code."""
    executor = LockstepExecutor()
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


def _read_arguments(arguments: list[str] | None) -> None:
    """Raise one of _OF_ARGUMENTS when they are not what ROS and this process take."""
    enter_environment()
    check_arguments(sys.argv if arguments is None else arguments)
    unknown = remove_ros_args(arguments)[0 if arguments is not None else 1 :]
    if unknown:
        raise InputError(
            f"unknown argument {' '.join(unknown)}: expected --ros-args, and after it such as "
            "-p NAME:=VALUE or --params-file FILE"
        )


def _refused(error: Exception) -> int:
    ours = isinstance(error, (InputError, *_OF_NAMES_AND_PARAMETERS))
    expected = "" if ours else "expected ROS arguments: "
    print(f"error: {expected}{_in_one_line(error)}", file=sys.stderr)
    return EXIT_BAD_INPUT


def _in_one_line(error: Exception) -> str:
    return " ".join(str(error).split())
