"""The node supervisor: prints the name of each node that it hears on /diagnostics, and its own."""

import signal

from diagnostic_msgs.msg import DiagnosticArray
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from lockstep.machine.unfinished_ports import remove_unfinished_ports
from lockstep.node.diagnostics import TOPIC

NAME = "supervisor"
_PERIOD_S = 0.2


def main() -> None:
    """Listen in the domain of ROS_DOMAIN_ID until SIGTERM comes or nobody reads any more."""
    remove_unfinished_ports()
    context = Context()
    context.init(args=[])
    node = Node(NAME, context=context, start_parameter_services=False)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    node.create_subscription(DiagnosticArray, TOPIC, _say_who, 10)
    is_over = False

    def end(number: int, frame: object) -> None:
        nonlocal is_over
        is_over = True

    signal.signal(signal.SIGTERM, end)
    while not is_over:
        print(NAME, flush=True)
        executor.spin_once(timeout_sec=_PERIOD_S)
    executor.shutdown()
    node.destroy_node()
    context.try_shutdown()


def _say_who(message: DiagnosticArray) -> None:
    for status in message.status:
        print(status.hardware_id, flush=True)


if __name__ == "__main__":
    main()
