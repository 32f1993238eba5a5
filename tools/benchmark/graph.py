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

from lockstep.node.diagnostics import TOPIC
from tests.node_harness import Graph
from tests.supervised_run import SupervisedRun

# It answers each iteration once, so its count is the count of iterations.
_COUNTING_NODE = "vergence_rl"
_DOMAIN = re.compile(r"export ROS_DOMAIN_ID=(\d+)\n")
_STOP_LIMIT_S = 30.0
_BYTES_PER_MIB = 1 << 20


class MeasuredGraph:
    """A running graph and what is heard of it. Process ids are looked up at each sample."""

    def __init__(self, graph: Graph, run: SupervisedRun) -> None:
        """graph: where the run is."""
        self._graph = graph
        self._run = run
        # Seconds on the monotonic clock, and iterations until then.
        self.samples: list[tuple[float, int]] = []
        self.peak_memory_mb: dict[str, float] = {}
        node = graph.add(
            lambda **kwargs: Node("benchmark", start_parameter_services=False, **kwargs)
        )
        node.create_subscription(DiagnosticArray, TOPIC, self._hear, 50)

    def _hear(self, message: DiagnosticArray) -> None:
        for status in message.status:
            if status.hardware_id == _COUNTING_NODE:
                values = {entry.key: entry.value for entry in status.values}
                self.samples.append((time.monotonic(), int(values["observations"])))
                self._measure_memory()

    def _measure_memory(self) -> None:
        """Note each process's memory; a page that several share is divided among them."""
        for name, process_id in ({"supervisor": self._run.process.pid} | self._run.nodes()).items():
            with contextlib.suppress(psutil.NoSuchProcess):
                memory_mb = psutil.Process(process_id).memory_full_info().pss / _BYTES_PER_MIB
                self.peak_memory_mb[name] = max(self.peak_memory_mb.get(name, 0.0), memory_mb)

    def _listen_until(self, is_enough: Callable[[], bool]) -> None:
        self._graph.spin_until(lambda: self.samples and is_enough(), "the graph")

    def await_start(self, n_iterations: int) -> None:
        """Listen until so many iterations are done."""
        self._listen_until(lambda: self.samples[-1][1] >= n_iterations)

    def window(self, duration_s: float) -> list[tuple[float, int]]:
        """Listen for so long from the last sample on; return the samples."""
        i_first = len(self.samples) - 1
        end_s = self.samples[-1][0] + duration_s
        self._listen_until(lambda: self.samples[-1][0] >= end_s)
        return self.samples[i_first:]


def rate_hz(samples: list[tuple[float, int]]) -> float:
    """Return iterations per second between the first and the last of two or more samples."""
    (first_s, n_first), (last_s, n_last) = samples[0], samples[-1]
    return (n_last - n_first) / (last_s - first_s)


@contextlib.contextmanager
def supervised_run(arguments: list[str], directory: Path) -> Iterator[MeasuredGraph]:
    """Run the graph as run_experiment.sh does, with its supervisor; interrupt it at the end.

    What it says goes to a file beside the directory. Raises RuntimeError when the run ends before
    it has begun.
    """
    with SupervisedRun(arguments, directory) as run:
        run.wait_until(lambda: _DOMAIN.search(run.output()) is not None, "the domain")
        domain = _DOMAIN.search(run.output())
        if domain is None:
            raise RuntimeError(f"the run ended with exit code {run.wait()}:\n{run.output()}")
        with contextlib.closing(Graph(int(domain[1]))) as graph:
            yield MeasuredGraph(graph, run)
        run.process.send_signal(signal.SIGINT)
        with contextlib.suppress(subprocess.TimeoutExpired):
            run.process.wait(_STOP_LIMIT_S)
