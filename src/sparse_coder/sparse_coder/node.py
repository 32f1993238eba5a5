"""The node sparse_coder: features and reward for each observation of the plant."""

import sys
import time
from collections.abc import Mapping
from typing import Any

from sensor_msgs.msg import Image, JointState

from lockstep.node.learner_node import LearnerNode
from lockstep.node.process import run_node
from lockstep.wire.images import ImagePublisher
from lockstep.wire.topics import BASIS_FUNCTIONS, PICTURES, REWARD_NAMES, TRAINING
from lockstep.wire.vectors import VectorPublisher, values_of, whole_values_of
from sparse_coder.coder import SparseCoder
from sparse_coder.config import SparseCoderConfig
from sparse_coder.messages import basis_functions_message, features_message, picture_of
from sparse_coder.perception import perceive

# Half a megabyte each time, for people to look at.
_BASIS_FUNCTIONS_PERIOD_S = 1.0

INPUTS = dict.fromkeys(PICTURES, Image) | {"episode": JointState, "muscle_activations": JointState}


class SparseCoderNode(LearnerNode[SparseCoder]):
    """Encodes each pair of pictures once, publishes, and only then learns from it."""

    # It learns while the others answer: they need the other core.
    core_of_two = 1

    def __init__(self, **kwargs: Any) -> None:
        """Set up the coder; raises InputError for a bad configuration."""
        super().__init__("sparse_coder", SparseCoderConfig, INPUTS, **kwargs)
        self._features = ImagePublisher(self, "features", features_message(self.config.n_bases))
        self._reward = VectorPublisher(self, "reward", REWARD_NAMES)
        self._basis_functions = ImagePublisher(
            self, BASIS_FUNCTIONS, basis_functions_message(self.config.n_bases)
        )
        self._sent_basis_functions_s = 0.0

    def make_learner(self) -> SparseCoder:
        """Return a coder with the dictionaries of its seed."""
        return SparseCoder(self.config)

    def answer(self, stamp_ns: int, observation: Mapping[str, Any]) -> None:
        """Publish features and reward, then let the dictionaries learn while others work."""
        left, right = (picture_of(observation[topic], topic) for topic in PICTURES)
        (phase,) = whole_values_of(observation["episode"], ("phase",), "episode")
        rates_w = values_of(
            observation["muscle_activations"],
            self.config.space.muscle_names,
            "muscle_activations",
            "effort",
        )
        percept = perceive(self.learner, left, right, rates_w)
        self._reward.publish(stamp_ns, percept.reward_values())
        self._features.publish(stamp_ns, percept.encoding.features)
        self._show_basis_functions(stamp_ns)
        if phase == TRAINING:
            self.learner.learn(percept.encoding)

    def _show_basis_functions(self, stamp_ns: int) -> None:
        """Publish those that have made this answer, now and then, while someone subscribes."""
        now_s = time.monotonic()
        is_due = now_s - self._sent_basis_functions_s >= _BASIS_FUNCTIONS_PERIOD_S
        if is_due and self._basis_functions.publisher.get_subscription_count():
            self._sent_basis_functions_s = now_s
            self._basis_functions.publish(stamp_ns, self.learner.atoms())

    def repeat(self) -> None:
        """Publish the last features and reward again."""
        self._reward.repeat()
        self._features.repeat()


def main() -> None:
    """Run the node until it is told to stop."""
    sys.exit(run_node(SparseCoderNode))


if __name__ == "__main__":
    main()
