"""Graphs that run to be measured: started, listened to, and stopped.

The listener reads /diagnostics, one message a second from each node, and so disturbs nothing.
"""

import contextlib
import re
import signal
import subprocess
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

import psutil
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import JointState

from lockstep.node.diagnostics import TOPIC
from lockstep.wire.qos import LOCKSTEP_QOS
from tests.benchmark.samples import Sample
from tests.stress.supervised_run import nodes_of
from tests.supervisor import start_supervisor

# It answers each iteration once, so its count is the count of iterations.
_COUNTING_NODE = "vergence_rl"
_LIMIT_S = 600.0
_POLL_S = 0.02
_DOMAIN = re.compile(r"export ROS_DOMAIN_ID=(\d+)\n")
_STOP_LIMIT_S = 30.0
_KIB_PER_MIB = 1024.0


class MeasuredGraph:
    """A running graph and what is heard of it. Process ids are looked up at each sample."""

    def __init__(
        self, domain: int, process_ids: Callable[[], Mapping[str, int]], started_s: float
    ) -> None:
        """process_ids: of the nodes that run, by name; started_s: when, on the monotonic clock."""
        self._started_s = started_s
        self.samples: list[Sample] = []
        self._first_episode_s: float | None = None
        self.peak_memory_mb: dict[str, float] = {}
        self._process_ids = process_ids
        self._context = Context()
        self._context.init(domain_id=domain)
        self._node = Node(
            f"benchmark_{domain}", context=self._context, start_parameter_services=False
        )
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._node.create_subscription(DiagnosticArray, TOPIC, self._hear, 50)
        self._episodes = self._node.create_subscription(
            JointState, "episode", self._hear_episode, LOCKSTEP_QOS
        )

    def close(self) -> None:
        """Stop listening."""
        self._executor.shutdown()
        self._node.destroy_node()
        self._context.try_shutdown()

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
        for name, process_id in self._process_ids().items():
            with contextlib.suppress(psutil.NoSuchProcess, OSError):
                times = psutil.Process(process_id).cpu_times()
                cpu_s[name] = times.user + times.system
                peak_mb = self.peak_memory_mb.get(name, 0.0)
                self.peak_memory_mb[name] = max(peak_mb, _memory_mb(process_id))
        machine = psutil.cpu_times()
        busy_s = sum(machine) - machine.idle - machine.iowait
        self.samples.append(Sample(time_s, n_iterations, cpu_s, busy_s))

    def listen_until(self, is_enough: Callable[[], bool]) -> None:
        """Listen; raises RuntimeError when a node has ended or it takes minutes."""
        end_s = time.monotonic() + _LIMIT_S
        while not is_enough():
            self._executor.spin_once(timeout_sec=0.2)
            if time.monotonic() > end_s:
                raise RuntimeError(f"the graph did not get there in {_LIMIT_S:.0f} s")

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

        def is_enough() -> bool:
            new = self.samples[i_first:]
            return bool(new) and new[-1].time_s - new[0].time_s >= duration_s

        self.listen_until(is_enough)
        return self.samples[i_first:]


def _memory_mb(process_id: int) -> float:
    """Return how much memory a process has resident, its part of what it shares with others.

    Linux, /proc/PID/smaps_rollup: Pss.
    """
    lines = Path(f"/proc/{process_id}/smaps_rollup").read_text().splitlines()
    line = next((line for line in lines if line.startswith("Pss:")), "Pss: 0 kB")
    return int(line.split()[1]) / _KIB_PER_MIB


@contextlib.contextmanager
def supervised_run(arguments: list[str], directory: Path) -> Iterator[MeasuredGraph]:
    """Run the graph as run_experiment.sh does, with its supervisor; interrupt it at the end.

    What it says goes to a file beside the directory.
    """
    with directory.with_suffix(".log").open("w+") as log:
        started_s = time.monotonic()
        process = start_supervisor(["--out", str(directory), *arguments], output=log)
        try:
            graph = MeasuredGraph(
                _domain_told(Path(log.name)),
                lambda: {"supervisor": process.pid} | nodes_of(process.pid),
                started_s,
            )
            try:
                yield graph
            finally:
                graph.close()
        finally:
            process.send_signal(signal.SIGINT)
            try:
                process.wait(_STOP_LIMIT_S)
            except subprocess.TimeoutExpired:
                process.kill()


def _domain_told(log: Path) -> int:
    """Wait until a supervisor says in which domain it is; raises RuntimeError when it does not."""
    end_s = time.monotonic() + _LIMIT_S
    while (told := _DOMAIN.search(log.read_text())) is None:
        time.sleep(_POLL_S)
        if time.monotonic() > end_s:
            raise RuntimeError(f"the supervisor named no domain in {_LIMIT_S:.0f} s")
    return int(told[1])
