"""Starts a node under limits of its address space, and prints how each ended, as JSON.

All are forked from here, so that a limit means the same for each. The limits are those just below
the least one with which it starts, where it is chance what in ROS or Python lacks memory, and some
far below, where it is always the stack of a thread of Fast DDS.
"""

import json
import os
import resource
import signal
import sys
import tempfile
import traceback
from pathlib import Path

from diagnostic_msgs.srv import SelfTest
from rclpy.node import Node
from sensor_msgs.msg import Image, JointState

from lockstep.node.diagnostics import Diagnostics
from lockstep.node.process import run_node

MOST_BYTES = 1 << 29
STEP_BYTES = 3 << 17
N_LIMITS = 20
THREAD_STEPS = range(48, 80, 8)
# Fast DDS may wait for ever when it lacks memory.
_START_LIMIT_S = 10


class SmallNode(Node):
    """A node with some of everything; it ends once it is made."""

    def __init__(self) -> None:
        super().__init__("small")
        Diagnostics(self)
        self.create_publisher(Image, "picture", 10)
        self.create_subscription(JointState, "vector", print, 10)
        self.create_service(SelfTest, "test", print)
        os._exit(0)


def start(more_bytes: int) -> tuple[int, str]:
    """Start the node with so much more memory than now; return its exit code and last line."""
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    limit = pages * resource.getpagesize() + more_bytes
    with tempfile.TemporaryFile() as log:
        process_id = os.fork()
        if process_id == 0:
            for number in (1, 2):
                os.dup2(log.fileno(), number)
            signal.alarm(_START_LIMIT_S)
            resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
            os._exit(_node())
        _, status = os.waitpid(process_id, 0)
        log.seek(0)
        lines = log.read().decode(errors="replace").split("\n")
    return os.waitstatus_to_exitcode(status), next((line for line in lines[::-1] if line), "")


def _node() -> int:
    try:
        return run_node(SmallNode, [])
    except BaseException:
        traceback.print_exc()
        return 1


def main() -> None:
    """Find the least memory with which the node starts, then try with less and less."""
    fails, starts = 0, MOST_BYTES
    while starts - fails > STEP_BYTES:
        tried = (fails + starts) // 2
        fails, starts = (fails, tried) if start(tried)[0] == 0 else (tried, starts)
    steps = (*range(N_LIMITS), *THREAD_STEPS)
    json.dump([start(starts - i * STEP_BYTES) for i in steps], sys.stdout)


if __name__ == "__main__":
    main()
