"""A plant and two learners that know the protocol and nothing else, for the manager's tests."""

from typing import Any

from rclpy.clock import Clock as NodeClock
from rclpy.clock import ClockType
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Image, JointState

from eye_plant import Episode
from lockstep import InputError
from lockstep.node.diagnostics import Diagnostics
from lockstep.node.requests import RequestServer
from lockstep.wire.qos import LOCKSTEP_QOS
from lockstep.wire.stamps import to_time
from lockstep.wire.topics import EPISODE_NAMES, GROUND_TRUTH_NAMES, PLANT_VECTORS, reward_names
from lockstep.wire.vectors import VectorPublisher
from tests.pair import ACTOR_CRITIC_NAMES, COMMAND_NAMES, HORIZONTAL_RECTI
from tests.stamps import to_ns

PERIOD_NS = 200_000_000
_REPEAT_PERIOD_S = 0.1


class Scripted(Node):
    """Accepts requests, except the kind that it is told to refuse; records them all."""

    kinds: tuple[str, ...] = ("start_run", "save", "load", "end_run")

    def __init__(self, name: str, **kwargs: Any) -> None:
        super().__init__(name, **kwargs)
        self.asked: list[str] = []
        self.refuses = ""
        self.server = RequestServer(
            self, Diagnostics(self), {kind: self._handler(kind) for kind in self.kinds}
        )

    def _handler(self, kind: str) -> Any:
        def handle(arguments: dict[str, Any]) -> None:
            if kind == self.refuses:
                raise InputError("expected another episode")
            self.asked.append(kind)
            self.do(kind, arguments)

        return handle

    def do(self, kind: str, arguments: dict[str, Any]) -> None:
        """Do what was asked: a learner writes a file to the path of `save`."""
        if kind == "save":
            with open(arguments["path"], "w") as file:
                file.write(self.get_name())


class ScriptedPlant(Scripted):
    """Publishes observations of constant content, and repeats the last one again and again."""

    kinds = ("start_run", "episode", "end_run")

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("eye_plant", **kwargs)
        self.episodes: list[Episode] = []
        self._iteration = 0
        names = {
            "episode": EPISODE_NAMES,
            "ground_truth": GROUND_TRUTH_NAMES,
            "muscle_activations": HORIZONTAL_RECTI,
        }
        self._ends = {t: VectorPublisher(self, t, names.get(t, ("x",))) for t in PLANT_VECTORS}
        self._clock_end = self.create_publisher(Clock, "/clock", LOCKSTEP_QOS)
        self.create_publisher(Image, "left/image_raw", LOCKSTEP_QOS)
        self.create_subscription(JointState, "muscle_command", self._answered, LOCKSTEP_QOS)
        self._repeat_timer = self.create_timer(
            _REPEAT_PERIOD_S, self.send, clock=NodeClock(clock_type=ClockType.STEADY_TIME)
        )
        self._repeat_timer.cancel()

    def do(self, kind: str, arguments: dict[str, Any]) -> None:
        """Begin an episode, or end the run."""
        if kind == "episode":
            self.episodes.append(Episode.from_arguments(arguments))
            self._iteration = 0
            self._repeat_timer.reset()
            self.send()
        elif kind == "end_run":
            self._repeat_timer.cancel()

    def _answered(self, message: JointState) -> None:
        episode = self.episodes[-1]
        stamp_ns = (episode.first_observation + self._iteration) * PERIOD_NS
        if to_ns(message.header.stamp) == stamp_ns and self._iteration < episode.n_iterations:
            self._iteration += 1
            self.send()

    def send(self) -> None:
        """Publish the observation of now."""
        episode, i = self.episodes[-1], self._iteration
        number = episode.first_observation + i
        training = episode.training_iteration + (i if episode.phase == 0 else 0)
        numbers = (episode.phase, episode.test, episode.trial, episode.episode, i, training, number)
        measures = {
            "stimulus": episode.stimulus,
            "object_distance_m": episode.object_distance_m,
            "vergence_deg": 1.0,
            "desired_vergence_deg": 2.0,
            "vergence_error_deg": 1.0,
            "left_deviation_deg": -0.5,
            "right_deviation_deg": -0.5,
            "metabolic_rate_w": 1.5,
            "initial_metabolic_rate_w": 2.0,
            "optimal_metabolic_rate_w": 1.0,
        }
        of_truth = GROUND_TRUTH_NAMES[len(EPISODE_NAMES) :]
        values = {
            "episode": numbers,
            "ground_truth": (*numbers, *(measures.get(name, 0.0) for name in of_truth)),
            "muscle_activations": (0.1, 0.0, 0.1, 0.0),
        }
        for topic, end in self._ends.items():
            end.publish(number * PERIOD_NS, values.get(topic, (0.0,)))
        self._clock_end.publish(Clock(clock=to_time(number * PERIOD_NS)))


class ScriptedCoder(Scripted):
    """Answers each observation with a reward, unless it is mute; the last if it answers all."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("sparse_coder", **kwargs)
        self.is_mute = self.answers_all = False
        self._reward = VectorPublisher(self, "reward", reward_names())
        self.create_publisher(Image, "features", LOCKSTEP_QOS)
        self.create_subscription(Image, "left/image_raw", lambda m: None, LOCKSTEP_QOS)
        self.create_subscription(JointState, "episode", self._answer, LOCKSTEP_QOS)

    def _answer(self, message: JointState) -> None:
        phase, iteration = message.position[0], message.position[4]
        is_last = iteration == (20 if phase else 10)
        if not self.is_mute and (self.answers_all or not is_last):
            self._reward.publish(to_ns(message.header.stamp), (0.1, 0.1, 1.0, 0.1, -0.3, 0.0))


class ScriptedLearner(Scripted):
    """Answers each reward with a command."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("vergence_rl", **kwargs)
        self._command = VectorPublisher(self, "muscle_command", COMMAND_NAMES)
        self._thought = VectorPublisher(self, "actor_critic", ACTOR_CRITIC_NAMES)
        self.create_subscription(Image, "features", lambda m: None, LOCKSTEP_QOS)
        self.create_subscription(JointState, "reward", self._answer, LOCKSTEP_QOS)

    def _answer(self, message: JointState) -> None:
        stamp_ns = to_ns(message.header.stamp)
        self._thought.publish(stamp_ns, (0.0,) * len(ACTOR_CRITIC_NAMES))
        self._command.publish(stamp_ns, (0.1, 0.1))
