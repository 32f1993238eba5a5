"""The node sparse_coder: features and reward for each observation of the plant."""

import sys
import time
from collections.abc import Mapping
from typing import Any

import numpy as np
from sensor_msgs.msg import CameraInfo, Image, JointState

from lockstep import InputError
from lockstep.node.learner_node import LearnerNode
from lockstep.node.process import run_node
from lockstep.randomness import Moment
from lockstep.wire.images import ImagePublisher
from lockstep.wire.topics import (
    BASIS_FUNCTIONS,
    CAMERA_INFOS,
    GAZE,
    GAZE_NAMES,
    GAZE_TARGET,
    GIVEN_TARGET_NAMES,
    PICTURES,
    TARGET_NAMES,
    TRAINING,
    apart_pictures,
    reward_names,
    state_topic,
)
from lockstep.wire.vectors import VectorPublisher, values_of, whole_values_of
from sparse_coder.camera import central_view
from sparse_coder.coder import SparseCoder
from sparse_coder.config import SparseCoderConfig
from sparse_coder.messages import (
    basis_functions_message,
    camera_of,
    features_message,
    picture_of,
)
from sparse_coder.percept import NOT_GIVEN_DEG

# Half a megabyte each time, for people to look at.
_BASIS_FUNCTIONS_PERIOD_S = 1.0
_TARGET_DEPTH = 1  # only the last target counts

_EPISODE = ("phase", "iteration", "training_iteration")
INPUTS = dict.fromkeys(PICTURES, Image) | {"episode": JointState, "muscle_activations": JointState}
_NO_RATES_W = np.zeros(0)


class SparseCoderNode(LearnerNode[SparseCoder]):
    """Encodes each pair of pictures once, publishes, and only then learns from it."""

    # It learns while the others answer: they need the other core.
    core_of_two = 1

    def __init__(self, **kwargs: Any) -> None:
        """Set up the coder; raises InputError for a bad configuration."""
        super().__init__("sparse_coder", SparseCoderConfig, **kwargs)
        scales, n_bases = self.config.scales.names, self.config.n_bases
        self._features = ImagePublisher(self, "features", features_message(len(scales), n_bases))
        self._reward = VectorPublisher(self, "reward", reward_names(scales))
        self._basis_functions = ImagePublisher(
            self, BASIS_FUNCTIONS, basis_functions_message(len(scales), n_bases)
        )
        self._sent_basis_functions_s = 0.0
        self._wanted_deg: np.ndarray | None = None
        if self.config.learns_turns:
            self._gaze = VectorPublisher(self, GAZE, GAZE_NAMES)
        if self.config.fixation_iterations:
            self.create_subscription(JointState, GAZE_TARGET, self._take_target, _TARGET_DEPTH)

    def inputs(self) -> Mapping[str, type]:
        """Return pictures, episode and metabolic rates; of a robot's head, its cameras instead.

        Eyes do not know their optics: what a lens does to their pictures, they see as it is.
        """
        if not self.config.space.of_joints:
            return INPUTS | dict.fromkeys(self._apart_topics, Image)
        of_cameras = dict.fromkeys(PICTURES, Image) | dict.fromkeys(CAMERA_INFOS, CameraInfo)
        return of_cameras | {"episode": JointState, state_topic(self.config.space): JointState}

    def make_learner(self) -> SparseCoder:
        """Return a coder with the dictionaries of its seed."""
        return SparseCoder(self.config)

    def answer(self, stamp_ns: int, observation: Mapping[str, Any]) -> None:
        """Publish features and reward, then let the dictionaries learn while others work."""
        left, right = self._pictures(observation)
        episode = observation["episode"]
        phase, iteration, training_iteration = whole_values_of(episode, _EPISODE, "episode")
        (trial,) = values_of(episode, ("trial",), "episode")
        rates_w = self._rates_w(observation)
        given_deg = NOT_GIVEN_DEG
        if self.config.fixation_iterations:
            given_deg = self._given_deg(episode, phase, iteration)
        percept = self.learner.perceive(
            left,
            right,
            rates_w,
            apart=self._apart(observation),
            moment=Moment(int(trial), iteration, training_iteration),
            given_deg=given_deg,
        )
        if given_deg is self._wanted_deg:
            self._wanted_deg = None  # once it is looked at, not when a picture is refused
        if percept.gaze is not None:
            self._gaze.publish(stamp_ns, percept.gaze.values())
        self._reward.publish(stamp_ns, percept.reward_values())
        self._features.publish(stamp_ns, percept.encoding.features)
        self._show_basis_functions(stamp_ns)
        if phase == TRAINING:
            self.learner.learn(percept.encoding)

    def _pictures(self, observation: Mapping[str, Any]) -> list[np.ndarray]:
        """Return both grey pictures, as the coder takes them."""
        pictures = [picture_of(observation[topic], topic) for topic in PICTURES]
        if not self.config.space.of_joints:
            return pictures
        cameras = [camera_of(observation[topic], topic) for topic in CAMERA_INFOS]
        focal_px = self.config.camera.focal_length_px
        return [central_view(p, c, focal_px) for p, c in zip(pictures, cameras, strict=True)]

    @property
    def _apart_topics(self) -> tuple[str, ...]:
        return apart_pictures(self.config.scales)

    def _apart(self, observation: Mapping[str, Any]) -> list[np.ndarray]:
        """Return both eyes' pictures of each scale that has its own."""
        pictures = [picture_of(observation[topic], topic) for topic in self._apart_topics]
        return [np.stack(pair) for pair in zip(pictures[::2], pictures[1::2], strict=True)]

    def _rates_w(self, observation: Mapping[str, Any]) -> np.ndarray:
        """Return the metabolic rate of each muscle that is charged; joints have none."""
        space = self.config.space
        if space.of_joints:
            return _NO_RATES_W
        activations = observation["muscle_activations"]
        return values_of(activations, space.muscle_names, "muscle_activations", "effort")

    def _take_target(self, message: JointState) -> None:
        """Look there when the next fixation of training begins, whichever eye leads then."""
        try:
            self._wanted_deg = np.tile(values_of(message, TARGET_NAMES, GAZE_TARGET), (2, 1))
        except InputError as error:
            self.diagnostics.refuse(str(error))

    def _given_deg(self, episode: JointState, phase: int, iteration: int) -> np.ndarray:
        """Return the place that a fixation is given, (2, 2), as `perceive` takes it.

        What somebody wants comes before what the protocol gives, but not in tests.
        """
        given_deg, names = NOT_GIVEN_DEG, GIVEN_TARGET_NAMES
        if set(names) <= set(episode.name):
            given_deg = values_of(episode, names, "episode", may_lack=names).reshape(2, 2)
        begins = iteration % self.config.fixation_iterations == 0
        if begins and phase == TRAINING and self._wanted_deg is not None:
            return self._wanted_deg
        return given_deg

    def _show_basis_functions(self, stamp_ns: int) -> None:
        """Publish those that have made this answer, now and then, while someone subscribes."""
        now_s = time.monotonic()
        is_due = now_s - self._sent_basis_functions_s >= _BASIS_FUNCTIONS_PERIOD_S
        if is_due and self._basis_functions.publisher.get_subscription_count():
            self._sent_basis_functions_s = now_s
            self._basis_functions.publish(stamp_ns, self.learner.atoms())

    def repeat(self) -> None:
        """Publish the last features and reward again, and what they say of gaze."""
        if self.config.learns_turns:
            self._gaze.repeat()
        self._reward.repeat()
        self._features.repeat()


def main() -> None:
    """Run the node until it is told to stop."""
    sys.exit(run_node(SparseCoderNode))


if __name__ == "__main__":
    main()
