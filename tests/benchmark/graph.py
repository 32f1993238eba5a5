"""Graphs that run to be measured: started, listened to, and stopped.

The listener reads /diagnostics, one message a second from each node, and so disturbs nothing.
"""

import contextlib
import re
import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import psutil
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.node import Node
from sensor_msgs.msg import JointState

from lockstep.node.diagnostics import TOPIC
from lockstep.wire.qos import LOCKSTEP_QOS
from tests.benchmark.samples import Sample
from tests.node_harness import Graph
from tests.stress.supervised_run import SupervisedRun

# It answers each iteration once, so its count is the count of iterations.
_COUNTING_NODE = "vergence_rl"
_DOMAIN = re.compile(r"export ROS_DOMAIN_ID=(\d+)\n")
_STOP_LIMIT_S = 30.0
_BYTES_PER_MIB = 1 << 20


class MeasuredGraph:
    """A running graph and what is heard of it. Process ids are looked up at each sample."""

    def __init__(self, graph: Graph, run: SupervisedRun, started_s: float) -> None:
        """graph: where the run is; started_s: when, on the monotonic clock."""
        self._graph = graph
        self._run = run
        self._started_s = started_s
        self.samples: list[Sample] = []
        self._first_episode_s: float | None = None
        self.peak_memory_mb: dict[str, float] = {}
        self._node = graph.add(
            lambda **kwargs: Node(
                f"benchmark_{graph.domain}", start_parameter_services=False, **kwargs
            )
        )
        self._node.create_subscription(DiagnosticArray, TOPIC, self._hear, 50)
        self._episodes = self._node.create_subscription(
            JointState, "episode", self._hear_episode, LOCKSTEP_QOS
        )

    def _hear_episode(self, message: JointState) -> None:
        if self._first_episode_s is None:
            self._first_episode_s = time.monotonic()

    def _hear(self, message: DiagnosticArray) -> None:
        for status in message.status:
            if status.hardware_id == _COUNTING_NODE:
                values = {entry.key: entry.value for entry in status.values}
                self._sample(int(values["observations"]))

    def _sample(self, n_iterations: int) -> None:
        time_s = time.monotonic()
        cpu_s = {}
        for name, process_id in ({"supervisor": self._run.process.pid} | self._run.nodes()).items():
            with contextlib.suppress(psutil.NoSuchProcess):
                process = psutil.Process(process_id)
                times = process.cpu_times()
                cpu_s[name] = times.user + times.system
                # Its part, too, of what it shares with others.
                memory_mb = process.memory_full_info().pss / _BYTES_PER_MIB
                peak_mb = self.peak_memory_mb.get(name, 0.0)
                self.peak_memory_mb[name] = max(peak_mb, memory_mb)
        machine = psutil.cpu_times()
        busy_s = sum(machine) - machine.idle - machine.iowait
        self.samples.append(Sample(time_s, n_iterations, cpu_s, busy_s))

    def listen_until(self, is_enough: Callable[[], bool]) -> None:
        """Listen; raises AssertionError when it takes too long."""
        self._graph.spin_until(is_enough, "the graph")

    def await_start(self, n_iterations: int) -> float:
        """Listen until so many iterations are done; return the seconds to the first one.

        From then on episodes are no longer read, only what the nodes say once a second.
        """
        self.listen_until(lambda: self._first_episode_s is not None)
        assert self._first_episode_s is not None
        self._node.destroy_subscription(self._episodes)
        self.listen_until(
            lambda: bool(self.samples) and self.samples[-1].n_iterations >= n_iterations
        )
        return self._first_episode_s - self._started_s

    def window(self, duration_s: float) -> list[Sample]:
        """Listen for so long from the last sample on; return the samples."""
        i_first = len(self.samples) - 1
        end_s = self.samples[-1].time_s + duration_s
        self.listen_until(lambda: self.samples[-1].time_s >= end_s)
        return self.samples[i_first:]


@contextlib.contextmanager
def supervised_run(arguments: list[str], directory: Path) -> Iterator[MeasuredGraph]:
    """Run the graph as run_experiment.sh does, with its supervisor; interrupt it at the end.

    What it says goes to a file beside the directory. Raises RuntimeError when the run ends before
    it has begun.
    """
    started_s = time.monotonic()
    with SupervisedRun(arguments, directory) as run:
        run.wait_until(lambda: _DOMAIN.search(run.output()) is not None, "the domain")
        domain = _DOMAIN.search(run.output())
        if domain is None:
            raise RuntimeError(f"the run ended with exit code {run.wait()}:\n{run.output()}")
        with contextlib.closing(Graph(int(domain[1]))) as graph:
            yield MeasuredGraph(graph, run, started_s)
        run.process.send_signal(signal.SIGINT)
        with contextlib.suppress(subprocess.TimeoutExpired):
            run.process.wait(_STOP_LIMIT_S)
