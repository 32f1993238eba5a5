"""The node vergence_rl: a muscle command for each observation, and learning from the reward.

It sees features, reward and muscle activations, and never the ground truth.
"""

import sys
from collections.abc import Mapping
from typing import Any

from sensor_msgs.msg import Image, JointState

from lockstep.node.learner_node import LearnerNode
from lockstep.node.process import run_node
from lockstep.wire.topics import (
    GAZE,
    TRAINING,
    actor_critic_names,
    command_topic,
    state_topic,
)
from lockstep.wire.vectors import VectorPublisher, values_of, whole_values_of
from vergence_rl.agent import Agent
from vergence_rl.config import VergenceRlConfig
from vergence_rl.messages import activations_of, actor_critic_values, features_of, gaze_of

_INPUTS = {
    "episode": JointState,
    "reward": JointState,
    "features": Image,
}
_EPISODE = ("phase", "iteration", "training_iteration")


class VergenceRlNode(LearnerNode[Agent]):
    """Learns from the last step, then commands the next one."""

    def __init__(self, **kwargs: Any) -> None:
        """Set up actor and critic; raises InputError for a bad configuration."""
        super().__init__("vergence_rl", VergenceRlConfig, **kwargs)
        space = self.config.space
        self._command = VectorPublisher(self, command_topic(space), space.names)
        self._actor_critic = VectorPublisher(self, "actor_critic", actor_critic_names(space))

    def inputs(self) -> Mapping[str, type]:
        """Return features, reward and activations, and what turns of the eyes need."""
        of_turns = {GAZE: JointState} if self.config.learns_turns else {}
        return of_turns | {state_topic(self.config.space): JointState} | _INPUTS

    def make_learner(self) -> Agent:
        """Return an agent with the weights of its seed."""
        return Agent(self.config)

    def answer(self, stamp_ns: int, observation: Mapping[str, Any]) -> None:
        """Publish the command that follows from an observation, and what the learner thought."""
        features = features_of(observation["features"], len(self.config.scales.all))
        (reward_t,) = values_of(observation["reward"], ("reward",), "reward")
        phase, iteration, training_iteration = whole_values_of(
            observation["episode"], _EPISODE, "episode"
        )
        space = self.config.space
        activations = activations_of(observation[state_topic(space)], space)
        gaze = gaze_of(observation[GAZE], observation["reward"]) if GAZE in observation else {}
        in_training = phase == TRAINING
        decision = self.learner.observe(
            features,
            activations,
            float(reward_t),
            iteration,
            training_iteration,
            learning=in_training,
            exploration=in_training,
            **gaze,
        )
        self._command.publish(stamp_ns, decision.command)
        self._actor_critic.publish(
            stamp_ns, actor_critic_values(decision, self.learner.learning_steps)
        )

    def repeat(self) -> None:
        """Publish the last command again."""
        self._command.repeat()
        self._actor_critic.repeat()


def main() -> None:
    """Run the node until it is told to stop."""
    sys.exit(run_node(VergenceRlNode))


if __name__ == "__main__":
    main()
