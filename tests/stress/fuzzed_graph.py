"""Plant and learners at work under a hail of hostile input, and what it did to their numbers."""

import math
import time
from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from sensor_msgs.msg import Image, JointState

from experiment_manager.experiment.config import ExperimentManagerConfig
from experiment_manager.experiment.protocol import make_protocol
from experiment_manager.in_process.loop import make_loop
from experiment_manager.run.config_file import read_configuration
from experiment_manager.supervision.domains import own_domain
from experiment_manager.supervision.processes import MANAGER, PACKAGES
from eye_plant.episode import Episode
from lockstep.configuration import build
from lockstep.errors import InputError
from lockstep.node.requests import RequestClient, service_name
from lockstep.state_file import read_state
from lockstep.wire.qos import LOCKSTEP_QOS
from lockstep.wire.stamps import period_ns
from tests.patience import PATIENCE_S
from tests.stamps import to_ns
from tests.stress.fuzzer import IMAGE_TOPICS, VECTOR_NAMES, Hostility
from tests.stress.lone_nodes import LoneNodes
from vergence_rl.messages import actor_critic_values

NODES = tuple(package for package in PACKAGES if package != MANAGER)
_RUN = "fuzzed"
_LONGEST_TOLD = 500
_BYTES_PER_MB = 1 << 20

Rows = dict[int, tuple[float, ...]]


@dataclass(frozen=True)
class FuzzReport:
    """What came of it.

    n_inputs: hostile ones sent; n_refused: counted by the nodes in /diagnostics; n_compared:
    numbers compared with those of an undisturbed run; differences: what differed; growth_mb: of
    the memory of each node, from the first to the last episode; told: the inputs, if only some were
    sent.
    """

    n_inputs: int
    n_refused: int
    n_compared: int
    differences: list[str]
    growth_mb: dict[str, float]
    told: list[str]


class _Driver(Node):
    """Requests the episodes, and throws hostile input at the nodes while they work."""

    def __init__(
        self, context: Context, hostility: Hostility, kept: Collection[int] | None
    ) -> None:
        super().__init__("driver", context=context)
        self.hostility = hostility
        self.asks = {name: RequestClient(self, name) for name in NODES}
        self.rows: dict[str, Rows] = {"ground_truth": {}, "actor_critic": {}}
        self.refused: dict[str, int] = {}
        self._kept = kept
        self._n_drawn = 0
        self.n_inputs = 0
        self.told: list[str] = []
        for topic in self.rows:
            self.create_subscription(JointState, topic, self._take(topic), LOCKSTEP_QOS)
        self.create_subscription(DiagnosticArray, "/diagnostics", self._hear, 10)
        self._ends = {
            topic: self.create_publisher(kind, topic, LOCKSTEP_QOS)
            for kind, topics in ((JointState, tuple(VECTOR_NAMES)), (Image, IMAGE_TOPICS))
            for topic in topics
        }
        self._requests = {
            name: self.create_client(SetParametersAtomically, service_name(name)) for name in NODES
        }
        self._parameters = {
            name: self.create_client(SetParameters, f"{name}/set_parameters") for name in NODES
        }

    def _take(self, topic: str) -> Any:
        def take(message: JointState) -> None:
            stamp_ns = to_ns(message.header.stamp)
            self.rows[topic].setdefault(stamp_ns, tuple(message.position))

        return take

    def _hear(self, message: DiagnosticArray) -> None:
        for status in message.status:
            values = {entry.key: entry.value for entry in status.values}
            self.refused[status.hardware_id] = int(values["refused_inputs"])

    def is_matched(self) -> bool:
        """Whether each end has somebody at the other."""
        return (
            all(end.get_subscription_count() for end in self._ends.values())
            and all(self.count_publishers(topic) for topic in self.rows)
            and all(client.service_is_ready() for client in self._requests.values())
            and all(client.service_is_ready() for client in self._parameters.values())
        )

    def attack(self, now_ns: int) -> None:
        """Draw a hostile input, and send it unless it is among those left out."""
        if not self.hostility.is_request():
            topic, message = self.hostility.message(now_ns)
            if self._is_kept(now_ns, topic, message):
                self._ends[topic].publish(message)
            return
        node = self.hostility.node(NODES)
        parameters = self.hostility.request(_RUN)
        if not self._is_kept(now_ns, node, parameters):
            return
        atomic = SetParametersAtomically.Request(parameters=parameters)
        self._requests[node].call_async(atomic)
        of_the_node = [Parameter("seed", value=7).to_parameter_msg(), *parameters]
        self._parameters[node].call_async(SetParameters.Request(parameters=of_the_node))

    def _is_kept(self, now_ns: int, to: str, what: Any) -> bool:
        number, self._n_drawn = self._n_drawn, self._n_drawn + 1
        if self._kept is None:
            self.n_inputs += 1
            return True
        if number not in self._kept:
            return False
        self.n_inputs += 1
        self.told.append(f"input {number} at {now_ns} ns to {to}: {str(what)[:_LONGEST_TOLD]}")
        return True


class FuzzedGraph:
    """The nodes as processes, an attacked driver, and the run they ought to make."""

    def __init__(self, config_file: Path, seed: int) -> None:
        """config_file: of a run; seed: of what is thrown at it."""
        self._config_file = config_file
        configuration = read_configuration(config_file)
        manager = build(ExperimentManagerConfig, configuration["experiment_manager"])
        self._configuration = configuration
        self._protocol = make_protocol(manager)
        self._period_ns = period_ns(manager.mechanics.period_s)
        self._seed = seed

    def run(
        self,
        n_episodes: int,
        n_inputs_per_observation: int,
        logs: Path,
        kept: Collection[int] | None = None,
    ) -> FuzzReport:
        """Drive the nodes through the first episodes under attack; compare with the loop.

        kept: numbers of the inputs to send, of those that are drawn, None sends all.
        """
        with own_domain() as domain, LoneNodes(NODES, self._config_file, domain, logs) as processes:
            context = Context()
            context.init(domain_id=domain)
            executor = SingleThreadedExecutor(context=context)
            driver = _Driver(context, Hostility(self._seed, self._period_ns), kept)
            executor.add_node(driver)
            try:
                attack = _Attack(driver, executor, processes, self._period_ns)
                attack.run(self._protocol_episodes(n_episodes), n_inputs_per_observation, logs)
            finally:
                executor.shutdown()
                driver.destroy_node()
                context.try_shutdown()
        differing, n_compared = self._compare(n_episodes, driver.rows, logs)
        return FuzzReport(
            driver.n_inputs,
            sum(driver.refused.values()),
            n_compared,
            differing,
            attack.growth_mb,
            driver.told,
        )

    def _protocol_episodes(self, n_episodes: int) -> list[Episode]:
        return [self._protocol.episode(place) for place in range(n_episodes)]

    def _compare(self, n_episodes: int, rows: dict[str, Rows], logs: Path) -> tuple[list[str], int]:
        """Return what differs from the same episodes in one process, and how much was compared."""
        loop = make_loop(self._configuration)
        expected: dict[str, Rows] = {"ground_truth": {}, "actor_critic": {}}
        for episode in self._protocol_episodes(n_episodes):
            for step in loop.run_episode(episode):
                stamp_ns = step.observation.number * self._period_ns
                expected["ground_truth"][stamp_ns] = step.observation.ground_truth_values()
                if step.answer is not None:
                    expected["actor_critic"][stamp_ns] = actor_critic_values(
                        step.answer.decision, step.answer.agent_learning_steps
                    )
        loop.plant.close()
        found = [
            f"{topic} at {stamp_ns} ns: {rows[topic].get(stamp_ns)} instead of {row}"
            for topic, wanted in expected.items()
            for stamp_ns, row in wanted.items()
            if not _equal(rows[topic].get(stamp_ns), row)
        ]
        n_compared = sum(len(row) for wanted in expected.values() for row in wanted.values())
        for name, learner in (("sparse_coder", loop.coder), ("vergence_rl", loop.agent)):
            state = read_state(logs / f"{name}.npz", name)
            for key, array in learner.state().items():
                n_compared += array.size
                if state[key].tobytes() != array.tobytes():
                    found.append(f"{name}: {key} of the learner's state")
        return found, n_compared


class _Attack:
    """One pass through the episodes."""

    def __init__(
        self,
        driver: _Driver,
        executor: SingleThreadedExecutor,
        processes: LoneNodes,
        period_ns: int,
    ) -> None:
        self._driver = driver
        self._executor = executor
        self._processes = processes
        self._period_ns = period_ns
        self.growth_mb: dict[str, float] = {}

    def run(self, episodes: list[Episode], n_inputs_per_observation: int, logs: Path) -> None:
        self._spin_until(self._driver.is_matched, "the nodes to appear")
        for name in NODES:
            self._ask(name, "start_run", {})
        before: dict[str, float] = {}
        for episode in episodes:
            self._episode(episode, n_inputs_per_observation)
            # What a node needs once, such as its largest buffers, it has by the first episode.
            before = before or self._memory_mb()
        self.growth_mb = {k: mb - before[k] for k, mb in self._memory_mb().items()}
        for name in NODES[1:]:
            self._ask(name, "save", {"path": str((logs / f"{name}.npz").resolve())})
        heard = self._driver.refused
        heard.clear()
        self._spin_until(lambda: len(heard) == len(NODES), "the nodes' counts")

    def _episode(self, episode: Episode, n_inputs_per_observation: int) -> None:
        driver = self._driver
        answers = self._send("eye_plant", "episode", episode.as_arguments())
        for iteration in range(episode.n_iterations + 1):
            now_ns = (episode.first_observation + iteration) * self._period_ns
            self._await_truth(now_ns)
            for _ in range(n_inputs_per_observation):
                driver.attack(now_ns)
        answered = {
            (episode.first_observation + i) * self._period_ns for i in range(episode.n_iterations)
        }
        self._spin_until(lambda: answered <= driver.rows["actor_critic"].keys(), "the answers")
        self._spin_until(lambda: bool(answers), "the plant's acknowledgement")

    def _await_truth(self, stamp_ns: int) -> None:
        truth = self._driver.rows["ground_truth"]
        self._spin_until(lambda: stamp_ns in truth, f"ground truth at {stamp_ns} ns")

    def _ask(self, name: str, kind: str, arguments: dict[str, Any]) -> None:
        answers = self._send(name, kind, arguments)
        self._spin_until(lambda: bool(answers), f"{name} to answer {kind}")

    def _send(self, name: str, kind: str, arguments: dict[str, Any]) -> list[bool]:
        """Ask a node; return a list that will hold its answer."""
        answers: list[bool] = []

        def take(successful: bool, reason: str) -> None:
            _accept(successful, reason)
            answers.append(successful)

        self._driver.asks[name].ask(_RUN, kind, arguments, take)
        return answers

    def _spin_until(self, condition: Any, what: str) -> None:
        end_s = time.monotonic() + PATIENCE_S
        while not condition():
            self._executor.spin_once(timeout_sec=0.1)
            if ended := self._processes.exit_codes():
                raise InputError(f"nodes ended while waiting for {what}: {ended}")
            if time.monotonic() > end_s:
                raise TimeoutError(f"waited {PATIENCE_S} s in vain for {what}")

    def _memory_mb(self) -> dict[str, float]:
        return {k: memory_mb(pid) for k, pid in self._processes.process_ids().items()}


def memory_mb(process_id: int) -> float:
    """Return the resident memory of a process."""
    n_pages = int(Path(f"/proc/{process_id}/statm").read_text().split()[1])
    return n_pages * 4096 / _BYTES_PER_MB


def _accept(successful: bool, reason: str) -> None:
    if not successful:
        raise InputError(f"a node refused what it should have done: {reason}")


def _equal(got: tuple[float, ...] | None, expected: tuple[float, ...]) -> bool:
    if got is None or len(got) != len(expected):
        return False
    return all(
        a == b or (math.isnan(a) and math.isnan(b))
        for a, b in zip(got, np.array(expected, dtype=np.float64).tolist(), strict=True)
    )
