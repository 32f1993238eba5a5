"""The messages of a small bag, and the bag."""

from pathlib import Path

from experiment_manager.bag.writer import BagWriter

TOPICS = {
    "ground_truth": "sensor_msgs/msg/JointState",
    "left/image_raw": "sensor_msgs/msg/Image",
    "/clock": "rosgraph_msgs/msg/Clock",
    "/diagnostics": "diagnostic_msgs/msg/DiagnosticArray",
}
METADATA = {"run_id": "run_7", "model": "M_C", "seed": "3"}
NAMES = ["vergence_deg", "metabolic_rate_w"]
PERIOD_NS = 100_000_000
N_MESSAGES = 30


def write_bag(directory: Path, messages: list[tuple[str, bytes, int]], n_per_file: int = 9) -> None:
    """Write these messages, so many of them in each file."""
    with BagWriter(directory, TOPICS, METADATA, configuration="run: {model: M_C}\n") as writer:
        for i, message in enumerate(messages):
            writer.write(*message)
            if (i + 1) % n_per_file == 0:
                writer.commit()
