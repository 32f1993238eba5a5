"""An example plant: eyes that jump to their angles, in front of noise that moves with them.

It publishes all that a plant publishes, and answers the requests (docs/reference/topics.md).
"""

import math

import numpy as np
import rclpy
from rcl_interfaces.srv import SetParametersAtomically
from rclpy.node import Node
from rclpy.parameter import parameter_value_to_python
from sensor_msgs.msg import Image, JointState

PERIOD_NS = 200_000_000  # the control period of the parameter set k17
MUSCLES = [f"{s}_{m}_rectus" for s in ("left", "right") for m in ("medial", "lateral")]
EPISODE = ("phase", "test", "trial", "episode", "iteration", "training_iteration", "observation")
NOISE = np.random.default_rng(0).integers(256, size=(240, 640), dtype=np.uint8)


class Plant(Node):
    """Both eyes turn in by 37.7 deg per medial and out by 40.9 deg per lateral activation."""

    def __init__(self) -> None:
        """Offer the topics and the service of a plant."""
        super().__init__("my_plant")
        self.asked: dict = {}
        self.i, self.pair = 0, (0.0, 0.0)
        self.eyes = [self.create_publisher(Image, f"{s}/image_raw", 64) for s in ("left", "right")]
        topics = ("muscle_states", "muscle_activations", "ground_truth", "episode", "eye_states")
        self.vectors = {name: self.create_publisher(JointState, name, 64) for name in topics}
        self.create_subscription(JointState, "muscle_command", self.command, 64)
        self.create_service(SetParametersAtomically, "eye_plant/request", self.answer)
        self.create_timer(1.0, self.publish)  # who starts late joins at a repeat

    def answer(self, request, response):
        """Begin an episode; the same request again is only acknowledged again."""
        asked = {p.name: parameter_value_to_python(p.value) for p in request.parameters}
        if asked["request"] == "episode" and asked != self.asked:
            self.asked, self.i = asked, 0
            self.pair = tuple(asked["activations"][:2])  # the left eye's; both have the same
            self.publish()
        response.result.successful = True
        return response

    def command(self, message: JointState) -> None:
        """Execute the answer to the last observation; repeats of older ones are ignored."""
        stamp_ns = message.header.stamp.sec * 10**9 + message.header.stamp.nanosec
        if self.asked and stamp_ns == self.stamp_ns() and self.i < self.asked["n_iterations"]:
            told = dict(zip(message.name, message.position, strict=True))
            self.pair = told["medial_rectus"], told["lateral_rectus"]
            self.i += 1
            self.publish()

    def stamp_ns(self) -> int:
        """Observations count the control periods of the run."""
        return (self.asked["first_observation"] + self.i) * PERIOD_NS

    def publish(self) -> None:
        """Send the observation, without pictures when the last command has been executed."""
        if not self.asked:
            return
        asked, (medial, lateral) = self.asked, self.pair
        adduction = 0.498 + 37.7 * medial - 40.9 * lateral
        desired = math.degrees(2.0 * math.atan(0.056 / 2.0 / asked["object_distance_m"]))
        trained = asked["training_iteration"] + (self.i if asked["phase"] == 0 else 0)
        counted = asked | {"iteration": self.i, "training_iteration": trained}
        counted["observation"] = asked["first_observation"] + self.i
        rates = [2.2 * max(medial, 0.005) ** 0.6, 2.0 * max(lateral, 0.005) ** 0.6] * 2
        truth = {name: counted[name] for name in (*EPISODE, "stimulus", "object_distance_m")} | {
            "vergence_deg": 2.0 * adduction,
            "desired_vergence_deg": desired,
            "vergence_error_deg": desired - 2.0 * adduction,
            "vertical_error_deg": 0.0,
            "cyclovergence_error_deg": 0.0,
            "version_deg": 0.0,
            "elevation_deg": 0.0,
            "left_torsion_deg": 0.0,
            "right_torsion_deg": 0.0,
            "left_deviation_deg": adduction - desired / 2.0,
            "right_deviation_deg": adduction - desired / 2.0,
            "metabolic_rate_w": sum(rates),
            "initial_metabolic_rate_w": 1.4,
            "optimal_metabolic_rate_w": 0.4,
            "target_sideways_deg": 0.0,
            "target_up_deg": 0.0,
        }
        if self.i < asked["n_iterations"]:
            shift = round(257.34 * math.tan(math.radians(desired / 2.0 - adduction)))
            for eye, first in zip(self.eyes, (160 - shift, 160 + shift), strict=True):
                eye.publish(self.picture(NOISE[:, first : first + 320]))
        self.send("muscle_states", MUSCLES, [0.04] * 4)
        self.send("muscle_activations", MUSCLES, [medial, lateral] * 2, rates)
        self.send("ground_truth", truth, truth.values())
        self.send("episode", EPISODE, [counted[name] for name in EPISODE])
        angles_rad = [math.radians(adduction)] * 2
        self.send("eye_states", ["left_adduction", "right_adduction"], angles_rad)

    def send(self, topic, names, position, effort=()) -> None:
        """Send a vector of named values."""
        message = JointState(name=list(names), position=[float(v) for v in position])
        message.effort = list(effort)
        self.vectors[topic].publish(self.stamped(message))

    def picture(self, grey: np.ndarray) -> Image:
        """Return a picture of 240 x 320 grey pixels."""
        message = Image(height=240, width=320, encoding="mono8", step=320, data=grey.tobytes())
        return self.stamped(message)

    def stamped(self, message):
        """All that belongs to an observation carries its stamp."""
        stamp = message.header.stamp
        stamp.sec, stamp.nanosec = divmod(self.stamp_ns(), 10**9)
        return message


if __name__ == "__main__":
    rclpy.init()
    rclpy.spin(Plant())
