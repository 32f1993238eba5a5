"""Plant and learners at work under a hail of hostile input, and what it did to their numbers."""

from collections.abc import Callable, Collection, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from subprocess import Popen
from typing import Any

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
from rclpy.node import Node
from rclpy.parameter import Parameter
from sensor_msgs.msg import Image, JointState

from experiment_manager.experiment.config import ExperimentManagerConfig
from experiment_manager.experiment.protocol import make_protocol
from experiment_manager.in_process.loop import make_loop
from experiment_manager.run.config_file import read_configuration
from experiment_manager.supervision.processes import MANAGER, PACKAGES
from eye_plant.episode import Episode
from lockstep.configuration import build
from lockstep.errors import InputError
from lockstep.node.diagnostics import TOPIC as DIAGNOSTICS
from lockstep.node.requests import RequestClient, service_name
from lockstep.state_file import read_state
from lockstep.wire.qos import LOCKSTEP_QOS
from lockstep.wire.stamps import period_ns
from tests.node_harness import Graph, ros_graph
from tests.stamps import to_ns
from tests.stress.fuzzer import IMAGE_TOPICS, VECTOR_NAMES, Hostility
from tests.stress.lone_node import LoneNode
from tests.stress.supervised_run import memory_mb
from vergence_rl.messages import actor_critic_values

NODES = tuple(package for package in PACKAGES if package != MANAGER)
_RUN = "fuzzed"
_LONGEST_SHOWN = 500

Rows = dict[int, tuple[float, ...]]


@dataclass(frozen=True)
class FuzzReport:
    """What came of it.

    n_inputs: hostile ones sent; n_refused: counted by the nodes in /diagnostics; n_compared:
    numbers compared with those of an undisturbed run; differences: what differed; growth_mb: of
    the memory of each node, from the first to the last episode; shown: the inputs, if only some
    were sent.
    """

    n_inputs: int
    n_refused: int
    n_compared: int
    differences: list[str]
    growth_mb: dict[str, float]
    shown: list[str]


class _Driver(Node):
    """Requests the episodes, and throws hostile input at the nodes while they work."""

    def __init__(self, hostility: Hostility, kept: Collection[int] | None, **kwargs: Any) -> None:
        super().__init__("driver", **kwargs)
        self._hostility = hostility
        self.asks = {name: RequestClient(self, name) for name in NODES}
        self.rows: dict[str, Rows] = {"ground_truth": {}, "actor_critic": {}}
        self.refused: dict[str, int] = {}
        self._kept = kept
        self._n_drawn = 0
        self.n_inputs = 0
        self.shown: list[str] = []
        for topic in self.rows:
            self.create_subscription(JointState, topic, self._take(topic), LOCKSTEP_QOS)
        self.create_subscription(DiagnosticArray, DIAGNOSTICS, self._hear, 10)
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

    def _take(self, topic: str) -> Callable[[JointState], None]:
        def take(message: JointState) -> None:
            self.rows[topic].setdefault(to_ns(message.header.stamp), tuple(message.position))

        return take

    def _hear(self, message: DiagnosticArray) -> None:
        for status in message.status:
            values = {entry.key: entry.value for entry in status.values}
            self.refused[status.hardware_id] = int(values["refused_inputs"])

    def is_matched(self) -> bool:
        """Whether each end has somebody at the other."""
        clients = (*self._requests.values(), *self._parameters.values())
        return (
            all(end.get_subscription_count() for end in self._ends.values())
            and all(self.count_publishers(topic) for topic in self.rows)
            and all(client.service_is_ready() for client in clients)
        )

    def attack(self, now_ns: int) -> None:
        """Draw a hostile input, and send it unless it is among those left out."""
        if not self._hostility.is_request():
            topic, message = self._hostility.message(now_ns)
            if self._is_kept(now_ns, topic, message):
                self._ends[topic].publish(message)
            return
        node = self._hostility.node(NODES)
        parameters = self._hostility.request(_RUN)
        if not self._is_kept(now_ns, node, parameters):
            return
        atomic = SetParametersAtomically.Request(parameters=parameters)
        self._requests[node].call_async(atomic)
        of_the_node = [Parameter("seed", value=7).to_parameter_msg(), *parameters]
        self._parameters[node].call_async(SetParameters.Request(parameters=of_the_node))

    def _is_kept(self, now_ns: int, to: str, what: Any) -> bool:
        number, self._n_drawn = self._n_drawn, self._n_drawn + 1
        if self._kept is not None:
            if number not in self._kept:
                return False
            text = str(what)[:_LONGEST_SHOWN]
            self.shown.append(f"input {number} at {now_ns} ns to {to}: {text}")
        self.n_inputs += 1
        return True


class FuzzedGraph:
    """The nodes as processes, an attacked driver, and the run they ought to make."""

    def __init__(self, config_file: Path, seed: int) -> None:
        """config_file: of a run; seed: of what is thrown at it."""
        self._config_file = config_file
        self._configuration = read_configuration(config_file)
        manager = build(ExperimentManagerConfig, self._configuration["experiment_manager"])
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
        episodes = [self._protocol.episode(place) for place in range(n_episodes)]
        hostility = Hostility(self._seed, self._period_ns)
        with ros_graph() as graph, ExitStack() as running:
            nodes = {
                name: running.enter_context(
                    LoneNode(name, self._config_file, graph.domain, logs / f"{name}.log")
                ).process
                for name in NODES
            }
            driver = graph.add(lambda **kwargs: _Driver(hostility, kept, **kwargs))
            attack = _Attack(graph, driver, nodes, self._period_ns)
            attack.run(episodes, n_inputs_per_observation, logs)
        differing, n_compared = self._compare(episodes, driver.rows, logs)
        return FuzzReport(
            driver.n_inputs,
            sum(driver.refused.values()),
            n_compared,
            differing,
            attack.growth_mb,
            driver.shown,
        )

    def _compare(
        self, episodes: Sequence[Episode], rows: dict[str, Rows], logs: Path
    ) -> tuple[list[str], int]:
        """Return what differs from the same episodes in one process, and how much was compared."""
        loop = make_loop(self._configuration)
        expected: dict[str, Rows] = {"ground_truth": {}, "actor_critic": {}}
        for episode in episodes:
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
            if not np.array_equal(rows[topic].get(stamp_ns, ()), row, equal_nan=True)
        ]
        n_compared = sum(len(row) for wanted in expected.values() for row in wanted.values())
        for name, learner in loop.learners.items():
            state = read_state(logs / f"{name}.npz", name)
            for key, array in learner.state().items():
                n_compared += array.size
                if state[key].tobytes() != array.tobytes():
                    found.append(f"{name}: {key} of the learner's state")
        return found, n_compared


class _Attack:
    """One pass through the episodes."""

    def __init__(
        self, graph: Graph, driver: _Driver, nodes: dict[str, Popen[str]], period_ns: int
    ) -> None:
        self._graph = graph
        self._driver = driver
        self._nodes = nodes
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
        rows = self._driver.rows
        answers = self._send("eye_plant", "episode", episode.as_arguments())
        stamps_ns = [
            (episode.first_observation + i) * self._period_ns
            for i in range(episode.n_iterations + 1)
        ]
        for now_ns in stamps_ns:
            is_there = partial(rows["ground_truth"].__contains__, now_ns)
            self._spin_until(is_there, f"ground truth at {now_ns} ns")
            for _ in range(n_inputs_per_observation):
                self._driver.attack(now_ns)
        answered = set(stamps_ns[:-1])
        self._spin_until(lambda: answered <= rows["actor_critic"].keys(), "the answers")
        self._spin_until(lambda: bool(answers), "the plant's acknowledgement")

    def _ask(self, name: str, kind: str, arguments: dict[str, Any]) -> None:
        answers = self._send(name, kind, arguments)
        self._spin_until(lambda: bool(answers), f"{name} to answer {kind}")

    def _send(self, name: str, kind: str, arguments: dict[str, Any]) -> list[bool]:
        """Ask a node; return a list that will hold its answer."""
        answers: list[bool] = []

        def take(successful: bool, reason: str) -> None:
            if not successful:
                raise InputError(f"a node refused what it should have done: {reason}")
            answers.append(successful)

        self._driver.asks[name].ask(_RUN, kind, arguments, take)
        return answers

    def _spin_until(self, condition: Callable[[], bool], what: str) -> None:
        def holds() -> bool:
            ended = [name for name, node in self._nodes.items() if node.poll() is not None]
            if ended:
                raise InputError(f"nodes ended while waiting for {what}: {ended}")
            return condition()

        self._graph.spin_until(holds, what)

    def _memory_mb(self) -> dict[str, float]:
        return {name: memory_mb(node.pid) for name, node in self._nodes.items()}
