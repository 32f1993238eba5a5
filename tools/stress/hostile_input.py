"""Plant and learners at work under hostile input, and what it did to their numbers."""

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from subprocess import Popen
from typing import Any

import numpy as np
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
from rclpy.parameter import Parameter
from sensor_msgs.msg import Image, JointState

from experiment_manager import InProcessLoop, make_loop, protocol_of
from experiment_manager.nodes import MOVABLE_NODES
from experiment_manager.run.config_file import configuration_text, read_configuration
from eye_plant import Episode
from lockstep import InputError, read_state
from lockstep.wire.qos import QUEUE_DEPTH
from lockstep.wire.stamps import period_ns
from tests.command_lines import configured
from tests.node_harness import Graph, Outsider, ros_graph
from tests.stamps import to_ns
from tests.supervised_run import memory_mb
from tests.supervisor import LoneNode
from tools.stress.fuzzer import IMAGE_TOPICS, LARGEST_BYTES, VECTOR_NAMES, Hostility
from tools.stress.kills import LINE
from vergence_rl.messages import actor_critic_values

# What the middleware's queues keep: the largest message in each of their places, of four topics.
BOUND_MB = 4 * QUEUE_DEPTH * LARGEST_BYTES / 2**20
_RUN = "fuzzed"
_TAKEN = dict.fromkeys(VECTOR_NAMES, JointState) | dict.fromkeys(IMAGE_TOPICS, Image)
_COMPARED = ("ground_truth", "actor_critic")
_REQUEST_SHARE = 0.1
# Of a pass, and at each of its observations.
_EPISODES, _INPUTS = 40, 20
_MOST_SHOWN = 5

# By topic and stamp in ns.
Rows = dict[str, dict[int, tuple[float, ...]]]


def fuzz(directory: Path, n_inputs: int, seed: int) -> tuple[dict[str, Any], list[str]]:
    """Send hostile input to the nodes, n_inputs in all, pass after pass with seeds from seed on.

    Returns figures, and what went wrong.
    """
    config_file = directory / "config.yaml"
    config_file.write_text(configuration_text(configured(*LINE)))
    reports: list[FuzzReport] = []
    problems: list[str] = []
    while (n_done := sum(report.n_inputs for report in reports)) < n_inputs and not problems:
        logs = directory / f"seed_{seed + len(reports)}"
        logs.mkdir()
        report = fuzzed(config_file, seed + len(reports), _EPISODES, _INPUTS, logs)
        problems = [f"{logs.name}: {text}" for text in report.differences[:_MOST_SHOWN]]
        if (growth_mb := max(report.growth_mb.values())) > BOUND_MB:
            problems.append(f"{logs.name}: memory grew by {growth_mb} MB, expected {BOUND_MB:.0f}")
        reports.append(report)
        print(
            f"{n_done + report.n_inputs} of {n_inputs} inputs, {problems or 'all held'}", flush=True
        )
    figures = {
        "inputs": n_done,
        "refused": sum(report.n_refused for report in reports),
        "numbers_compared": sum(report.n_compared for report in reports),
        "growth_mb": round(max(max(report.growth_mb.values()) for report in reports), 1),
    }
    return figures, problems


@dataclass(frozen=True)
class FuzzReport:
    """What came of it.

    n_inputs: hostile ones sent; n_refused: counted by the nodes in /diagnostics; n_compared:
    numbers compared with those of the loop in one process; differences: what differed; growth_mb:
    of the memory of each node, from the first to the last episode.
    """

    n_inputs: int
    n_refused: int
    n_compared: int
    differences: list[str]
    growth_mb: dict[str, float]


class Driver(Outsider):
    """Requests the episodes, and throws hostile input at the nodes while they work."""

    def __init__(self, hostility: Hostility, **kwargs: Any) -> None:
        """hostility: draws what is thrown; kwargs: of the node."""
        super().__init__(_TAKEN, dict.fromkeys(_COMPARED, JointState), **kwargs)
        self._hostility = hostility
        self._parameters = {
            name: self.create_client(SetParameters, f"{name}/set_parameters")
            for name in MOVABLE_NODES
        }

    def is_ready(self) -> bool:
        """Whether all nodes are there."""
        return (
            self.is_matched()
            and all(self.has_service(name) for name in MOVABLE_NODES)
            and all(client.service_is_ready() for client in self._parameters.values())
        )

    def rows(self) -> Rows:
        """Return what the nodes have said so far, the first of each stamp."""
        return {
            topic: {to_ns(m.header.stamp): tuple(m.position) for m in self.distinct(topic)}
            for topic in _COMPARED
        }

    def attack(self, now_ns: int) -> None:
        """Throw one hostile input, while the observation of now_ns is under way."""
        if self._hostility.draw.random() >= _REQUEST_SHARE:
            self.send(*self._hostility.message(now_ns))
            return
        node = str(self._hostility.draw.choice(MOVABLE_NODES))
        parameters = self._hostility.request(_RUN)
        self.client_of(node).call_async(SetParametersAtomically.Request(parameters=parameters))
        of_the_node = [Parameter("seed", value=7).to_parameter_msg(), *parameters]
        self._parameters[node].call_async(SetParameters.Request(parameters=of_the_node))


def fuzzed(
    config_file: Path, seed: int, n_episodes: int, n_inputs_per_observation: int, logs: Path
) -> FuzzReport:
    """Drive the nodes through a run's first episodes under attack; compare with the loop.

    config_file: of the run; seed: of what is thrown; logs: directory for logs and learners' states.
    """
    configuration = read_configuration(config_file)
    protocol, loop = protocol_of(configuration), make_loop(configuration)
    episodes = [protocol.episode(place) for place in range(n_episodes)]
    step_ns = period_ns(loop.plant.oculomotor.control_period_s)
    with ros_graph() as graph, ExitStack() as running:
        nodes = {
            name: running.enter_context(
                LoneNode(name, config_file, graph.domain, logs / f"{name}.log")
            ).process
            for name in MOVABLE_NODES
        }
        driver: Driver = graph.add(partial(Driver, Hostility(seed, step_ns)))
        attack = _Attack(graph, driver, nodes)
        growth_mb = attack.run(episodes, step_ns, n_inputs_per_observation, logs)
    n_inputs = n_inputs_per_observation * sum(episode.n_iterations + 1 for episode in episodes)
    n_refused = sum(int(status["refused_inputs"]) for status in driver.status_of.values())
    n_compared, differences = _compare(loop, episodes, step_ns, driver.rows(), logs)
    return FuzzReport(n_inputs, n_refused, n_compared, differences, growth_mb)


class _Attack:
    """One pass through the episodes."""

    def __init__(self, graph: Graph, driver: Driver, nodes: dict[str, Popen[str]]) -> None:
        self._graph, self._driver, self._nodes = graph, driver, nodes

    def run(
        self, episodes: Sequence[Episode], step_ns: int, n_inputs: int, logs: Path
    ) -> dict[str, float]:
        """Make the episodes, with n_inputs at each observation; return the nodes' growth in MB."""
        self._spin_until(self._driver.is_ready, "the nodes to appear")
        for name in MOVABLE_NODES:
            self._ask(name, "start_run", {})()
        before_mb: dict[str, float] = {}
        for episode in episodes:
            first = episode.first_observation
            numbers = range(first, first + episode.n_iterations + 1)
            await_plant = self._ask(MOVABLE_NODES[0], "episode", episode.as_arguments())
            self._attack_all([number * step_ns for number in numbers], n_inputs)
            await_plant()
            # What a node needs once, such as its largest buffers, it has by the first episode.
            before_mb = before_mb or self._memory_mb()
        growth_mb = {name: mb - before_mb[name] for name, mb in self._memory_mb().items()}
        for name in MOVABLE_NODES[1:]:
            self._ask(name, "save", {"path": str((logs / f"{name}.npz").resolve())})()
        status_of = self._driver.status_of
        status_of.clear()
        self._spin_until(lambda: len(status_of) == len(MOVABLE_NODES), "the nodes' counts")
        return growth_mb

    def _attack_all(self, stamps_ns: Sequence[int], n_inputs: int) -> None:
        """Attack at each observation of an episode, and wait for the last answer."""

        def has(topic: str, stamp_ns: int) -> bool:
            return stamp_ns in self._driver.stamps_ns(topic)

        for now_ns in stamps_ns:
            self._spin_until(partial(has, "ground_truth", now_ns), f"ground truth at {now_ns} ns")
            for _ in range(n_inputs):
                self._driver.attack(now_ns)
        self._spin_until(partial(has, "actor_critic", stamps_ns[-2]), "the last answer")

    def _ask(self, name: str, kind: str, arguments: dict[str, Any]) -> Callable[[], None]:
        """Send a request to a node; return a function that waits for it to be done."""
        values = {"run_id": _RUN, "request": kind} | arguments
        future = self._driver.future_answer(name, values)

        def wait() -> None:
            self._spin_until(future.done, f"{name} to answer {kind}")
            if not future.result().result.successful:
                raise InputError(f"{name} refused {kind}: {future.result().result.reason}")

        return wait

    def _spin_until(self, condition: Callable[[], object], what: str) -> None:
        def holds() -> object:
            if ended := [name for name, node in self._nodes.items() if node.poll() is not None]:
                raise InputError(f"nodes ended while waiting for {what}: {ended}")
            return condition()

        self._graph.spin_until(holds, what)

    def _memory_mb(self) -> dict[str, float]:
        return {name: memory_mb(node.pid) for name, node in self._nodes.items()}


def _compare(
    loop: InProcessLoop, episodes: Sequence[Episode], step_ns: int, rows: Rows, logs: Path
) -> tuple[int, list[str]]:
    """Return how many numbers were compared with the loop's own, and what differs."""
    expected: Rows = {topic: {} for topic in rows}
    for episode in episodes:
        for step in loop.run_episode(episode):
            stamp_ns = step.observation.number * step_ns
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
    return n_compared, found
