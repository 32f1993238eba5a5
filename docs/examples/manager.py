"""An example manager: ten training episodes, each of which prints the error at its end."""

import rclpy
from rcl_interfaces.srv import SetParametersAtomically
from rclpy.node import Node
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState

N_EPISODES, N_ITERATIONS = 10, 10
NODES = ("eye_plant", "sparse_coder", "vergence_rl")


class Manager(Node):
    """Asks each node to start the run, then the plant for one episode after the other."""

    def __init__(self) -> None:
        """Listen to the ground truth: a manager may."""
        super().__init__("my_manager")
        self.create_subscription(JointState, "ground_truth", self.look, 64)
        self.ask_for = {
            name: self.create_client(SetParametersAtomically, f"{name}/request") for name in NODES
        }
        self.n_done = 0

    def ask(self, name: str, kind: str, **arguments) -> None:
        """Send a request and wait for its answer; a refusal says why."""
        values = {"run_id": "by hand", "request": kind} | arguments
        parameters = [Parameter(k, value=v).to_parameter_msg() for k, v in values.items()]
        self.ask_for[name].wait_for_service()
        future = self.ask_for[name].call_async(
            SetParametersAtomically.Request(parameters=parameters)
        )
        rclpy.spin_until_future_complete(self, future)
        if not future.result().result.successful:
            raise SystemExit(f"{name}: {future.result().result.reason}")

    def begin(self, number: int) -> None:
        """Ask for the episode with that number, of 11 observations: the last has no answer."""
        self.ask(
            *("eye_plant", "episode"),
            **dict.fromkeys(("phase", "stimulus"), 0) | dict.fromkeys(("test", "trial"), -1),
            episode=number,
            training_iteration=number * N_ITERATIONS,
            object_distance_m=1.0 + number / 2.0,
            activations=2 * [0.05, 0.02, 0.0, 0.0, 0.0, 0.0],
            n_iterations=N_ITERATIONS,
            first_observation=number * (N_ITERATIONS + 1),
        )

    def look(self, message: JointState) -> None:
        """Note the end of an episode; repeats of it have the same numbers."""
        truth = dict(zip(message.name, message.position, strict=True))
        if truth["iteration"] == N_ITERATIONS and truth["episode"] == self.n_done:
            print(f"episode {self.n_done}: {truth['vergence_error_deg']:.2f} deg", flush=True)
            self.n_done += 1


if __name__ == "__main__":
    rclpy.init()
    manager = Manager()
    for node in NODES:
        manager.ask(node, "start_run")
    for topic in ("left/image_raw", "muscle_command", "features", "reward"):
        while not (manager.count_publishers(topic) and manager.count_subscribers(topic)):
            rclpy.spin_once(manager, timeout_sec=0.1)
    for i in range(N_EPISODES):
        manager.begin(i)
        while manager.n_done <= i:
            rclpy.spin_once(manager)
    for node in NODES:
        manager.ask(node, "end_run")
