"""The node experiment_manager: asks for one episode after another, and records them all."""

import struct
import sys
import time
from collections import deque
from collections.abc import Callable
from functools import partial
from importlib import import_module
from typing import Any

from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.subscription import Subscription

from experiment_manager.config import ExperimentManagerConfig
from experiment_manager.run.episode_record import (
    FREE_TOPICS,
    SAMPLED_TOPICS,
    SMALL_TOPICS,
    EpisodeRecord,
    learning_steps,
    takes_pictures,
)
from experiment_manager.run.run_directory import Run
from lockstep.diagnostics import Diagnostics
from lockstep.errors import InputError
from lockstep.exit_codes import EXIT_FAULT, EXIT_INTERRUPTED, EXIT_UNWRITABLE, FAULT_TEXT
from lockstep.parameters import declare_config
from lockstep.process import run_node
from lockstep.qos import LOCKSTEP_QOS
from lockstep.requests import END_RUN, START_RUN, Arguments, RequestClient
from lockstep.stamps import period_ns
from lockstep.topics import GROUND_TRUTH_NAMES, HORIZONTAL_RECTI, REWARD_NAMES, TEST, TOPIC_TYPES
from lockstep.vectors import Vector, VectorReader, values_of

LEARNERS = ("sparse_coder", "vergence_rl")
LEARNER_OF = {"reward": "sparse_coder", "actor_critic": "vergence_rl"}
PLANT = "eye_plant"
_WATCH_PERIOD_S = 0.5
# Of an observation, the plant sends its small messages while the others compute, this one last.
_LAST_TOPIC = "eye_states"
# A foreign node has no request service: a few seconds tell it from one that is still starting.
_SERVICE_WAIT_S = 5.0
_HEADER_STAMP = struct.Struct("<iI")
_HEADER_OFFSET = 4  # behind the CDR encapsulation


class ExperimentManagerNode(Node):
    """Drives a run: graph matched, run started, episodes one by one, checkpoints, results."""

    # Nobody waits for what is recorded.
    gives_way = True

    def __init__(self, **kwargs: Any) -> None:
        """Open the run directory; raises InputError when it cannot be used."""
        super().__init__("experiment_manager", **kwargs)
        self.exit_code = 0
        self.config = declare_config(self, ExperimentManagerConfig)
        self._period_ns = period_ns(self.config.mechanics.period_s)
        try:
            self.run = Run(self.config)
        except OSError as error:
            raise InputError(f"run directory: expected one to write into: {error}") from error
        self._record: EpisodeRecord | None = None
        # The one under way and the last one: a picture may come after all that is counted.
        self._records: deque[EpisodeRecord] = deque(maxlen=2)
        self._n_awaited = 0
        self._n_interrupts = 0
        self._is_over = False
        self._message_s = self._matched_s = time.monotonic()
        self._said_waiting = ""
        self.diagnostics = Diagnostics(self, self._state_of_run)
        self._ask = {name: RequestClient(self, name) for name in (PLANT, *LEARNERS)}
        self._subscriptions_of_pictures: list[Subscription] = []
        self._recorded = {topic: self._subscribe(topic) for topic in (*SMALL_TOPICS, *FREE_TOPICS)}
        measured = ("ground_truth", "muscle_activations", *LEARNER_OF)
        self._readers = {name: VectorReader(name) for name in measured}
        self._others_are_late = False
        self._next: Callable[[], None] = self._await_graph
        self.create_timer(
            _WATCH_PERIOD_S, self._watch, clock=Clock(clock_type=ClockType.STEADY_TIME)
        )
        self.get_logger().info(f"run {self.run.run_id} in {self.run.directory}")

    # The graph

    def _subscribe(self, topic: str) -> Subscription:
        package, folder, name = TOPIC_TYPES[topic].split("/")
        kind = getattr(import_module(f"{package}.{folder}"), name)
        return self.create_subscription(
            kind, topic, partial(self._receive, topic), LOCKSTEP_QOS, raw=True
        )

    def awaited_subscriptions(self) -> list[Subscription]:
        """Return the topic that comes last of an observation, and all when it came before others.

        To wake up for each message would take a core from the nodes whose answer is awaited.
        """
        if self._others_are_late:
            return list(self._recorded.values())
        return [self._recorded[_LAST_TOPIC]]

    def _await_graph(self) -> None:
        """Wait until whoever publishes a topic of the table is there, and who answers requests."""
        missing = [topic for topic in SMALL_TOPICS if not self.count_publishers(topic)]
        missing += [topic for topic in ("left/image_raw", "features") if not self._is_read(topic)]
        if missing:
            self._say_waiting(f"waiting for {', '.join(missing)}")
            self._matched_s = time.monotonic()
            return
        absent = [name for name, client in self._ask.items() if not client.is_there()]
        waited_s = time.monotonic() - self._matched_s
        if PLANT in absent or (absent and waited_s < _SERVICE_WAIT_S):
            self._say_waiting(f"waiting for the request service of {', '.join(absent)}")
            return
        for name in absent:
            self.get_logger().warning(
                f"{name} answers no requests: the run goes on, without checkpoints"
            )
            del self._ask[name]
        self._start_run()

    def _is_read(self, topic: str) -> bool:
        return bool(self.count_publishers(topic) and self.count_subscribers(topic))

    def _say_waiting(self, text: str) -> None:
        if text != self._said_waiting:
            self.get_logger().info(text)
            self._said_waiting = text

    def _start_run(self) -> None:
        self._next = _nothing
        self._sample_pictures()
        asks: list[tuple[str, str, Arguments]] = [(name, START_RUN, {}) for name in self._ask]
        loaded = self.run.states_to_load(self._learners())
        asks += [(name, "load", {"path": str(path)}) for name, path in loaded.items()]
        self._ask_all(asks, self._next_episode)

    def _learners(self) -> list[str]:
        return [name for name in LEARNERS if name in self._ask]

    def _ask_all(self, asks: list[tuple[str, str, Arguments]], then: Callable[[], None]) -> None:
        """Ask one after the other, then go on; a refusal is a fault.

        Who cannot save a state would have to be asked again at the same place, in vain.
        """
        if not asks:
            then()
            return
        (name, kind, arguments), *rest = asks

        def on_answer(successful: bool, reason: str) -> None:
            if successful:
                self._guarded(partial(self._ask_all, rest, then))
            else:
                code = EXIT_UNWRITABLE if kind == "save" else EXIT_FAULT
                self._fault(f"{name} refused {kind}: {reason}", code)

        self._ask[name].ask(self.run.run_id, kind, arguments, on_answer)

    # Episodes

    def _next_episode(self) -> None:
        self._next = _nothing
        run = self.run
        is_last = run.is_over
        if is_last or self._n_interrupts or run.checkpoint_is_due():
            self._checkpoint(self._finish if is_last or self._n_interrupts else self._request)
        else:
            self._request()

    def _request(self) -> None:
        episode = self.run.episode()
        self._sample_pictures()
        self._record = EpisodeRecord(episode, self._period_ns)
        self._records.appendleft(self._record)
        self._message_s = time.monotonic()
        self._n_awaited = 2
        self._ask_all([(PLANT, "episode", episode.as_arguments())], self._acknowledged)

    def _acknowledged(self) -> None:
        # The plant is busy now; what is drawn here costs the run no time.
        self.run.prepare()
        self._go_on()

    def _go_on(self) -> None:
        """Begin the next episode when the last one is both acknowledged and recorded."""
        self._n_awaited -= 1
        if self._n_awaited == 0:
            self._next_episode()

    def _sample_pictures(self) -> None:
        """Subscribe some episodes early, so that all is matched when the sampled one begins."""
        wanted = self.run.takes_pictures_soon()
        if wanted and not self._subscriptions_of_pictures:
            self._subscriptions_of_pictures = [self._subscribe(name) for name in SAMPLED_TOPICS]
        elif not wanted and self._subscriptions_of_pictures:
            for subscription in self._subscriptions_of_pictures:
                self.destroy_subscription(subscription)
            self._subscriptions_of_pictures = []

    def _receive(self, topic: str, message: bytes) -> None:
        self._guarded(partial(self._take, topic, message))

    def _take(self, topic: str, message: bytes) -> None:
        if self._is_over:
            return
        if topic == "/diagnostics":
            # Its own stamp is of another clock.
            self.run.writer.write(topic, message, self.run.stamp_ns)
            return
        stamp_s, stamp_rest_ns = _HEADER_STAMP.unpack_from(message, _HEADER_OFFSET)
        stamp_ns = stamp_s * 1_000_000_000 + stamp_rest_ns
        record = next((r for r in self._records if r.holds(stamp_ns)), None)
        if record is None:
            return
        if topic in SAMPLED_TOPICS and not takes_pictures(self.config, record.episode):
            return
        if not self.run.writer.write(topic, message, stamp_ns):
            return
        self._message_s = time.monotonic()
        if topic in FREE_TOPICS or topic in SAMPLED_TOPICS:
            return
        self.run.stamp_ns = max(self.run.stamp_ns, stamp_ns)
        self._measure(topic, message, record, stamp_ns)
        record.count(topic)
        if record.is_complete:
            self._end_episode()
        elif topic == _LAST_TOPIC and stamp_ns == record.last_ns:
            self._others_are_late = True

    def _measure(self, topic: str, message: bytes, record: EpisodeRecord, stamp_ns: int) -> None:
        if topic == "ground_truth":
            vector = self._readers[topic].read(message)
            self.run.add_truth(
                values_of(vector, GROUND_TRUTH_NAMES, topic), is_last=stamp_ns == record.last_ns
            )
        elif topic == "muscle_activations" and record.episode.phase == TEST:
            vector = self._readers[topic].read(message)
            self.run.add_activations(record.episode, values_of(vector, HORIZONTAL_RECTI, topic))
        elif topic in LEARNER_OF:
            vector = self._readers[topic].read(message)
            iteration = record.iteration(stamp_ns)
            self._check_learner(topic, vector, record, iteration)
            if topic == "reward":
                values = values_of(vector, REWARD_NAMES, topic)
                self.run.add_reward(record.episode, iteration, values)

    def _check_learner(
        self, topic: str, vector: Vector, record: EpisodeRecord, iteration: int
    ) -> None:
        """Find the learner that was restarted, or learned what it should not have."""
        if not self.config.supervised or LEARNER_OF[topic] not in self._ask:
            return
        expected = learning_steps(topic, record.episode, iteration)
        (found,) = values_of(vector, ("learning_steps",), topic)
        if found != expected:
            raise InputError(
                f"{LEARNER_OF[topic]}: expected {expected} learning steps in episode "
                f"{record.episode.episode}, got {found:g}"
            )

    def _end_episode(self) -> None:
        # What somebody else may have had a hand in does not get into a checkpoint.
        self._look_for_others()
        if self._is_over:
            return
        self._record = None
        self._others_are_late = False
        self.diagnostics.count()
        self.run.end_episode()
        self._go_on()

    # Checkpoints and the end

    def _checkpoint(self, then: Callable[[], None]) -> None:
        learners = self._learners()
        if len(learners) < len(LEARNERS):
            self.run.writer.commit()
            then()
            return
        paths = self.run.state_paths(learners)
        asks = [(name, "save", {"path": str(path)}) for name, path in paths.items()]

        def commit() -> None:
            self.run.commit(paths)
            then()

        self._ask_all(asks, commit)

    def _finish(self) -> None:
        if self.run.is_over:
            self.run.finish()
        else:
            self.exit_code = EXIT_INTERRUPTED
        self._ask_all([(name, END_RUN, {}) for name in self._ask], self._stop)

    def _fault(self, reason: str, code: int = EXIT_FAULT) -> None:
        if self._is_over:
            return
        self.exit_code = code
        self.get_logger().error(f"{FAULT_TEXT}{reason}")
        self._stop()

    def _stop(self) -> None:
        self._is_over = True
        self._record = None
        try:
            self.run.close()
        except OSError as error:
            self.get_logger().error(f"{self.run.directory} cannot be written: {error}")
        self.context.try_shutdown()

    def interrupt(self) -> None:
        """Stop after the episode under way, with a checkpoint; the second time, at once.

        Called from a signal handler, amid anything: it takes note, and the watch acts.
        """
        self._n_interrupts += 1

    def _watch(self) -> None:
        self._guarded(self._look)

    def _look(self) -> None:
        if self._is_over:
            return
        # Before the first episode there is nothing to wait for.
        if self._n_interrupts > 1 or (self._n_interrupts and self._next is not _nothing):
            self.exit_code = EXIT_INTERRUPTED
            self._stop()
            return
        self._next()
        self.run.writer.flush_when_due()
        if self._record is not None:
            self._look_for_faults(self._record)

    def _look_for_others(self) -> None:
        doubled = [topic for topic in SMALL_TOPICS if self.count_publishers(topic) > 1]
        if doubled:
            self._fault(f"expected one publisher per topic, found more on {', '.join(doubled)}")

    def _look_for_faults(self, record: EpisodeRecord) -> None:
        self._look_for_others()
        waited_s = time.monotonic() - self._message_s
        if waited_s <= self.config.gap_s:
            return
        missing = f"no message for {self.config.gap_s:g} s; missing: {record.missing()}"
        absent = [topic for topic in SMALL_TOPICS if not self.count_publishers(topic)]
        if self.config.supervised and not absent:
            self._fault(missing)
        else:
            # The plant repeats itself: whoever comes back can still answer, in as long again. The
            # supervisor knows of those that it has started; others may be behind a broken network.
            self._say_waiting(f"waiting for {', '.join(absent)}" if absent else missing)
            self._message_s = time.monotonic()

    def _guarded(self, act: Callable[[], None]) -> None:
        """Act; input that is refused and a disk that refuses are faults."""
        try:
            act()
        except InputError as error:
            self._fault(str(error))
        except OSError as error:
            self._fault(f"{self.run.directory} cannot be written: {error}", EXIT_UNWRITABLE)

    def destroy_node(self) -> None:
        """Close the bag with the node, if the run was ended from outside."""
        if not self._is_over:
            self.exit_code = EXIT_INTERRUPTED
            self._stop()
        super().destroy_node()

    def _state_of_run(self) -> dict[str, str]:
        return {"episode": str(self.run.place), "episodes": str(len(self.run.protocol))}


def _nothing() -> None:
    pass


def main() -> None:
    """Run the node until its run is over."""
    sys.exit(run_node(ExperimentManagerNode))


if __name__ == "__main__":
    main()
