"""An example controller: it tries activations and keeps those with the largest reward."""

import random

import rclpy
from rclpy.node import Node
from sensor_msgs.msg import Image, JointState

THOUGHTS = (
    *("value", "td_error", "td_variance", "actor_learning_rate", "critic_learning_rate"),
    *("medial_rectus_action", "lateral_rectus_action", "learning_steps"),
)


class Controller(Node):
    """Answers each observation with one command, by its stamp, which draws the noise as well."""

    def __init__(self) -> None:
        """Read features and reward, publish commands and placeholder values of a critic."""
        super().__init__("my_controller")
        self.command = self.create_publisher(JointState, "muscle_command", 64)
        self.thought = self.create_publisher(JointState, "actor_critic", 64)
        self.rewards: dict[int, float] = {}
        self.create_subscription(JointState, "reward", self.note, 64)
        self.create_subscription(Image, "features", self.answer, 64)

    def note(self, message: JointState) -> None:
        """Remember the reward of an observation."""
        stamp_ns = message.header.stamp.sec * 10**9 + message.header.stamp.nanosec
        self.rewards[stamp_ns] = message.position[message.name.index("reward")]

    def answer(self, message: Image) -> None:
        """Publish the command that was best in the last second, and some noise."""
        now_ns = message.header.stamp.sec * 10**9 + message.header.stamp.nanosec
        self.rewards = {at: r for at, r in self.rewards.items() if at > now_ns - 10**9}
        best_ns = max(self.rewards, key=self.rewards.__getitem__, default=now_ns)
        medial = 0.04 + random.Random(best_ns).uniform(-0.03, 0.03)
        pair = [medial + random.Random(now_ns).uniform(-0.005, 0.005), 0.01]
        names = ["medial_rectus", "lateral_rectus"]
        zeros = [0.0] * len(THOUGHTS)
        self.thought.publish(JointState(header=message.header, name=THOUGHTS, position=zeros))
        self.command.publish(JointState(header=message.header, name=names, position=pair))


if __name__ == "__main__":
    rclpy.init()
    rclpy.spin(Controller())
