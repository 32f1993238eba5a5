"""An example coder: features are differences of the pictures, the reward their negative sum."""

import numpy as np
import rclpy
from rclpy.node import Node
from sensor_msgs.msg import Image, JointState

INPUTS = {
    "left/image_raw": Image,
    "right/image_raw": Image,
    "episode": JointState,
    "muscle_activations": JointState,
}


class Coder(Node):
    """Features are differences of brightness, coarse and fine; it learns nothing."""

    def __init__(self) -> None:
        """Read the pictures, publish features and reward."""
        super().__init__("my_coder")
        self.features = self.create_publisher(Image, "features", 64)
        self.reward = self.create_publisher(JointState, "reward", 64)
        self.seen: dict[int, dict] = {}
        for topic, kind in INPUTS.items():
            self.create_subscription(kind, topic, lambda m, t=topic: self.gather(t, m), 64)

    def gather(self, topic: str, message) -> None:
        """Answer an observation when all of it is there; the messages of one share a stamp."""
        stamp_ns = message.header.stamp.sec * 10**9 + message.header.stamp.nanosec
        self.seen = {at: seen for at, seen in self.seen.items() if at >= stamp_ns - 10**9}
        seen = self.seen.setdefault(stamp_ns, {})
        seen[topic] = message
        if len(seen) == len(INPUTS):
            self.answer(seen)

    def answer(self, seen: dict) -> None:
        """Publish the reward, then the features; a repeated observation gets the same again."""
        left, right = (
            np.array(seen[topic].data).reshape(240, 320) for topic in INPUTS if "/" in topic
        )
        difference = np.abs(left.astype(np.float32) - right).reshape(240, 320) / 255.0
        coarse = difference.reshape(20, 12, 20, 16).mean(axis=(1, 3)).ravel()
        fine = difference[110:130, 150:170].ravel()
        features = np.stack([coarse, fine])
        errors = features.mean(axis=1).astype(float)
        effort = seen["muscle_activations"]
        rates = dict(zip(effort.name, effort.effort, strict=True))
        recti = [f"{s}_{m}_rectus" for s in ("left", "right") for m in ("medial", "lateral")]
        values = {
            "reconstruction_error_coarse": errors[0],
            "reconstruction_error_fine": errors[1],
            "metabolic_rate_w": sum(rates[name] for name in recti),
            "energy_penalty": 0.0,
            "reward": -errors.sum(),
            "learning_steps": 0.0,
        }
        header = seen["episode"].header
        self.reward.publish(
            JointState(header=header, name=list(values), position=[*map(float, values.values())])
        )
        picture = Image(header=header, height=2, width=400, encoding="32FC1", step=1600)
        picture.data = features.astype(np.float32).tobytes()
        self.features.publish(picture)


if __name__ == "__main__":
    rclpy.init()
    rclpy.spin(Coder())
