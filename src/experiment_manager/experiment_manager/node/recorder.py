"""What is recorded: the messages of each episode, until each expected one is in the bag."""

import time
from collections import deque
from collections.abc import Callable, Collection
from functools import partial
from importlib import import_module

from rclpy.node import Node
from rclpy.subscription import Subscription
from sensor_msgs.msg import JointState

from experiment_manager.config import ExperimentManagerConfig
from experiment_manager.node.fault_detection import LEARNER_OF, check_learning_steps
from experiment_manager.run.episode_record import EpisodeRecord, TimedRecord
from experiment_manager.run.picture_sample import takes_pictures
from experiment_manager.run.recorded_topics import FREE_TOPICS, SAMPLED_TOPICS, small_topics
from experiment_manager.run.run_directory import Run
from eye_plant import Episode
from lockstep.wire.cdr import stamp_of
from lockstep.wire.codec import Reader
from lockstep.wire.qos import LOCKSTEP_QOS, QUEUE_DEPTH
from lockstep.wire.stamps import NS_PER_S, period_ns
from lockstep.wire.topics import (
    GROUND_TRUTH_NAMES,
    JOINT_STATES,
    TEST,
    TOPIC_TYPES,
    reward_names,
    state_topic,
    unsure_reward_names,
    unsure_truth_names,
)
from lockstep.wire.vectors import values_of, whole_values_of

# Of an observation, the plant sends its small messages while the others compute, this one last.
_LAST_TOPIC, _LAST_TOPIC_OF_HEADS = "eye_states", JOINT_STATES
# Observations of a clock's time whose number has not come yet; more are somebody else's.
_N_PENDING = 8


class Recorder:
    """Writes what the graph sends into the run's bag, and counts up what it says."""

    def __init__(
        self,
        node: Node,
        run: Run,
        config: ExperimentManagerConfig,
        guard: Callable[[Callable[[], None]], None],
        on_complete: Callable[[], None],
    ) -> None:
        """guard: calls what a message sets off; on_complete: called when an episode is recorded."""
        self._node = node
        self._run = run
        self._config = config
        self._guard = guard
        self._on_complete = on_complete
        self._period_ns = period_ns(config.mechanics.period_s)
        # Learners whose learning steps must be those of the protocol.
        self.checked_learners: Collection[str] = ()
        self.record: EpisodeRecord | None = None
        # The one under way and the last one: a picture may come after all that is counted.
        self._records: deque[EpisodeRecord] = deque(maxlen=2)
        self._is_open = True
        self._hear()
        self._others_are_late = False
        space = config.space
        self._state_topic = state_topic(space)
        self._reward_names = reward_names(config.scales.names)
        self._last_topic = _LAST_TOPIC_OF_HEADS if space.of_joints else _LAST_TOPIC
        self._unsure = {
            "ground_truth": unsure_truth_names(space),
            "reward": unsure_reward_names(space),
        }
        # By stamp, of a head: what came before the message that numbers its observation.
        self._pending: dict[int, list[tuple[str, bytes]]] = {}
        self._read_episode = Reader(JointState, "episode")
        measured = ("ground_truth", self._state_topic, *LEARNER_OF)
        self._readers = {name: Reader(JointState, name) for name in measured}
        self._subscriptions_of_pictures: list[Subscription] = []
        self._small_topics = small_topics(config)
        recorded = (*self._small_topics, *FREE_TOPICS)
        self._recorded = {topic: self._subscribe(topic) for topic in recorded}

    def _subscribe(self, topic: str) -> Subscription:
        package, folder, name = TOPIC_TYPES[topic].split("/")
        kind = getattr(import_module(f"{package}.{folder}"), name)

        def receive(message: bytes) -> None:
            self._guard(partial(self._take, topic, message))

        return self._node.create_subscription(kind, topic, receive, LOCKSTEP_QOS, raw=True)

    def awaited_subscriptions(self) -> list[Subscription]:
        """Return the topic that comes last of an observation, and all when it came before others.

        To wake up for each message would take a core from the nodes whose answer is awaited.
        """
        if self._others_are_late:
            return list(self._recorded.values())
        return [self._recorded[self._last_topic]]

    def sample_pictures(self) -> None:
        """Subscribe some episodes early, so that all is matched when the sampled one begins."""
        wanted = self._run.takes_pictures_soon()
        if wanted and not self._subscriptions_of_pictures:
            self._subscriptions_of_pictures = [self._subscribe(name) for name in SAMPLED_TOPICS]
        elif not wanted and self._subscriptions_of_pictures:
            for subscription in self._subscriptions_of_pictures:
                self._node.destroy_subscription(subscription)
            self._subscriptions_of_pictures = []

    # Episodes

    def begin(self, episode: Episode) -> None:
        """Expect the messages of an episode."""
        if not self._records:
            self._forget_what_waits()
        self.record = (
            TimedRecord(episode, self._small_topics)
            if self._config.space.of_joints
            else EpisodeRecord(episode, self._period_ns, self._small_topics)
        )
        self._records.appendleft(self.record)
        # A picture of the last episode may still come, of those before nothing does.
        self._run.writer.release(self._records[-1].first_ns)
        self._hear()

    def _forget_what_waits(self) -> None:
        """Take what came before the first episode, and do nothing with it.

        A plant that outlives its run repeats its observation until the next run starts. Learners
        that have just been started answer it before they load their state, and if the run goes on
        with that very episode, the stamps of their answers are expected now.
        """
        stamped = [self._recorded[topic] for topic in self._small_topics]
        for subscription in (*stamped, *self._subscriptions_of_pictures):
            kind, raw, handle = subscription.msg_type, subscription.raw, subscription.handle
            for _ in range(QUEUE_DEPTH):
                if handle.take_message(kind, raw) is None:
                    break

    def end(self) -> None:
        """Expect nothing until the next episode begins."""
        self.record = None
        self._others_are_late = False

    def close(self) -> None:
        """Record nothing any more."""
        self.record = None
        self._is_open = False

    @property
    def silent_s(self) -> float:
        """Seconds since the last new message, or since the wait was restarted."""
        return time.monotonic() - self._message_s

    @property
    def unheard_s(self) -> float:
        """For how long no new message has come."""
        return time.monotonic() - self._heard_s

    def wait_from_now(self) -> None:
        """Give somebody time from now on."""
        self._message_s = time.monotonic()

    # Messages

    def _hear(self) -> None:
        """Count both kinds of silence from now on."""
        self._heard_s = self._message_s = time.monotonic()

    def _take(self, topic: str, message: bytes) -> None:
        if not self._is_open:
            return
        if topic == "/diagnostics":
            # Its own stamp is of another clock.
            self._run.writer.write(topic, message, self._run.stamp_ns)
            return
        seconds, nanoseconds = stamp_of(message)
        stamp_ns = seconds * NS_PER_S + nanoseconds
        record = next((r for r in self._records if r.holds(stamp_ns)), None)
        if record is not None:
            self._take_of(record, topic, message, stamp_ns)
        elif self._config.space.of_joints and topic not in FREE_TOPICS:
            self._take_early(topic, message, stamp_ns)

    def _take_early(self, topic: str, message: bytes, stamp_ns: int) -> None:
        """Hold back what belongs to an observation until its number comes."""
        pending = self._pending
        if stamp_ns not in pending and len(pending) >= _N_PENDING:
            del pending[next(iter(pending))]
        pending.setdefault(stamp_ns, []).append((topic, message))
        if topic != "episode":
            return
        (number,) = whole_values_of(self._read_episode(message), ("observation",), topic)
        early = pending.pop(stamp_ns)
        for record in tuple(self._records):
            if isinstance(record, TimedRecord) and record.note(stamp_ns, number):
                for held_topic, held in early:
                    self._take_of(record, held_topic, held, stamp_ns)

    def _take_of(self, record: EpisodeRecord, topic: str, message: bytes, stamp_ns: int) -> None:
        if topic in SAMPLED_TOPICS and not takes_pictures(self._config, record.episode):
            return
        if topic in self._small_topics and not record.expects(topic, stamp_ns):
            return
        is_new = self._run.writer.write(topic, message, stamp_ns)
        if topic in FREE_TOPICS or not is_new:
            # What a plant repeats while it waits in vain is no sign of progress.
            return
        self._hear()
        if topic in self._small_topics:
            self._count(topic, message, record, stamp_ns)

    def _count(self, topic: str, message: bytes, record: EpisodeRecord, stamp_ns: int) -> None:
        self._run.stamp_ns = max(self._run.stamp_ns, stamp_ns)
        if topic in self._readers:
            self._measure(topic, message, record, stamp_ns)
        record.count(topic)
        if record.is_complete:
            self._on_complete()
        elif topic == self._last_topic and stamp_ns == record.last_ns:
            self._others_are_late = True

    def _measure(self, topic: str, message: bytes, record: EpisodeRecord, stamp_ns: int) -> None:
        is_last = stamp_ns == record.last_ns
        if topic == self._state_topic and record.episode.phase != TEST and not is_last:
            return
        vector, progress = self._readers[topic](message), self._run.progress
        if topic == "ground_truth":
            truth = values_of(vector, GROUND_TRUTH_NAMES, topic, may_lack=self._unsure[topic])
            progress.add_truth(truth, is_last=is_last)
        elif topic == self._state_topic:
            values = values_of(vector, self._config.space.muscle_names, topic)
            progress.add_activations(record.episode.phase, values)
        else:
            self._measure_learner(topic, vector, record, stamp_ns)

    def _measure_learner(
        self, topic: str, vector: JointState, record: EpisodeRecord, stamp_ns: int
    ) -> None:
        if LEARNER_OF[topic] in self.checked_learners:
            (found,) = values_of(vector, ("learning_steps",), topic)
            check_learning_steps(topic, record, stamp_ns, float(found))
        if topic == "reward":
            episode = record.episode
            values = values_of(vector, self._reward_names, topic, may_lack=self._unsure[topic])
            training_iteration = episode.training_iteration + record.iteration(stamp_ns)
            self._run.progress.add_reward(episode.phase, training_iteration, values)
