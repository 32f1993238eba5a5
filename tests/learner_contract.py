"""The contract of both learners' nodes: answered once, learned from once, saved and loaded."""

import array
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import pytest
from sensor_msgs.msg import Image

from lockstep import InputError, write_state
from lockstep.wire.stamps import to_time
from lockstep.wire.topics import TEST, TRAINING
from tests.node_harness import Bench, Graph


def image_message(pixels: np.ndarray, encoding: str, stamp_ns: int) -> Image:
    """Return the message of pixels (height, width)."""
    height, width = pixels.shape
    step = width * pixels.itemsize
    message = Image(height=height, width=width, step=step, encoding=encoding)
    message.header.stamp = to_time(stamp_ns)
    message.data = array.array("B", pixels.tobytes())
    return message


Change = Callable[[dict[str, Any]], None]


def changed(topic: str, **changes: Any) -> Change:
    """Return what changes fields of one of an observation's messages."""

    def change(messages: dict[str, Any]) -> None:
        for name, value in changes.items():
            setattr(messages[topic], name, value)

    return change


class LearnerBench(Bench):
    """A learner's node whose run has started, to which observations are shown by their numbers."""

    def __init__(
        self,
        graph: Graph,
        node: Any,
        inputs: Mapping[str, type],
        answers: Mapping[str, type],
        observation: Callable[[int, int], dict[str, Any]],
        *,
        refused: Sequence[tuple[Change, str]] = (),
    ) -> None:
        """Start a run.

        observation: returns the messages {topic: message} of a number, its stamp in s; refused:
        changes of an observation, and what the node says of each.
        """
        super().__init__(graph, node, inputs, answers)
        self.inputs, self.answers, self.observation = set(inputs), tuple(answers), observation
        self.refused = refused
        assert self.request("start_run") == (True, "")

    def show(self, number: int, phase: int = TRAINING) -> None:
        """Send the messages of an observation."""
        self.send(self.observation(number, phase))

    def send(self, messages: Mapping[str, Any]) -> None:
        """Send messages {topic: message}."""
        for topic, message in messages.items():
            self.outsider.send(topic, message)

    def shown(self, *numbers: int, phase: int = TRAINING) -> None:
        """Show observations, one when the one before has been answered."""
        for number in numbers:
            n_heard = [len(self.outsider.heard[topic]) for topic in self.answers]
            self.show(number, phase)
            for topic, n in zip(self.answers, n_heard, strict=True):
                self.wait_heard(topic, n + 1)

    def wait_learned(self, n_steps: int) -> None:
        """Wait for as many learning steps: a learner answers before it learns."""
        self.graph.spin_until(lambda: self.node.learner.learning_steps == n_steps, "a lesson")

    def weights(self) -> dict[str, bytes]:
        """Return the bytes of the learner's state."""
        return bytes_of(self.node.learner)


def bytes_of(learner: Any) -> dict[str, bytes]:
    return {name: array.tobytes() for name, array in learner.state().items()}


class LearnerContract:
    """Tests for a module with the fixture `bench`, a LearnerBench."""

    def test_the_same_observation_is_answered_again_and_learned_from_once(self, bench) -> None:
        bench.shown(0)
        before = bench.node.learner.learning_steps
        bench.shown(1, 1, 1)
        for topic in bench.answers:
            _, first, second, third = bench.outsider.heard[topic]
            assert first == second == third
        bench.wait_learned(before + 1)

    def test_an_older_observation_is_ignored(self, bench: LearnerBench) -> None:
        for number in (5, 4, 6):
            bench.show(number)
        topic = bench.answers[-1]
        bench.wait_distinct(topic, 2)
        assert bench.outsider.stamps_ns(topic) == [5 * 10**9, 6 * 10**9]

    def test_bad_observations_are_refused_and_the_good_one_answered(self, bench) -> None:
        before = bench.weights()
        for n, (change, reason) in enumerate(bench.refused, start=1):
            messages = bench.observation(1, TRAINING)
            change(messages)
            bench.send(messages)
            assert reason in bench.wait_refused(n)
        assert bench.weights() == before
        # The same stamp, repeated whole, is still to be answered, and learned from once.
        bench.shown(1)
        assert all(bench.outsider.stamps_ns(topic) == [10**9] for topic in bench.answers)

    def test_tests_are_answered_and_not_learned_from(self, bench: LearnerBench) -> None:
        before = bench.weights()
        bench.shown(0, 1, phase=TEST)
        assert bench.weights() == before

    def test_a_saved_state_is_loaded_into_another_run(self, bench, tmp_path) -> None:
        path, untrained = str(tmp_path / "state.npz"), bench.weights()
        bench.shown(7, 8)
        bench.graph.spin_until(lambda: bench.weights() != untrained, "a lesson")
        assert bench.request("save", path=path) == (True, "")
        saved = bench.weights()
        assert bench.request("end_run") == (True, "")
        assert bench.request("start_run", run_id="next") == (True, "")
        assert bench.weights() == untrained
        assert bench.request("load", run_id="next", path=path) == (True, "")
        assert bench.weights() == saved
        # The stamps of another run begin at 0.
        bench.shown(0)

    @pytest.mark.parametrize("damage", ["missing", "foreign", "of another size"])
    def test_a_bad_state_is_refused_and_changes_nothing(self, bench, tmp_path, damage) -> None:
        path = tmp_path / "state.npz"
        state = bench.node.learner.state()
        if damage == "of another size":
            state = {name: np.repeat(array, 2) for name, array in state.items()}
        if damage != "missing":
            write_state(path, "nose" if damage == "foreign" else bench.name, state)
        before = bench.weights()
        successful, reason = bench.request("load", path=str(path))
        assert not successful
        assert str(path) in reason
        assert bench.weights() == before

    def test_a_state_that_cannot_be_saved_is_refused(self, bench, tmp_path) -> None:
        successful, reason = bench.request("save", path=str(tmp_path / "nowhere" / "state.npz"))
        assert not successful
        assert "cannot be written" in reason
        for arguments in ({}, {"path": ""}, {"path": "."}, {"path": 3}, {"path": "a", "more": 1}):
            assert "expected the path of a state file" in bench.request("save", **arguments)[1]

    def test_it_answers_without_a_run(self, bench: LearnerBench) -> None:
        assert bench.request("end_run") == (True, "")
        bench.shown(1)

    def test_it_never_hears_the_ground_truth(self, bench: LearnerBench) -> None:
        found = bench.node.get_subscriber_names_and_types_by_node(bench.name, "/")
        assert {name.lstrip("/") for name, _ in found} == bench.inputs
        assert "ground_truth" not in bench.inputs

    def test_an_unknown_parameter_is_refused(self, bench: LearnerBench) -> None:
        with pytest.raises(InputError, match="unknown parameter gamma"):
            bench.graph.add(type(bench.node), gamma=0.3)
