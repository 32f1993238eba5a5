"""An episode of the plant's node, step by step."""

from pathlib import Path
from typing import Any

from sensor_msgs.msg import Image, JointState

from eye_plant import Episode
from eye_plant.mechanics.mujoco_model import MechanicsConfig
from eye_plant.node.plant_node import EyePlantNode
from lockstep.wire.stamps import period_ns
from lockstep.wire.topics import MEAN_METABOLIC_RATES, PICTURES, PLANT_VECTORS, TRAINING
from lockstep.wire.vectors import vector_message
from tests.node_harness import Bench, Graph
from tests.pair import pair_activations

PERIOD_NS = period_ns(MechanicsConfig().period_s)
HEARD = {
    **dict.fromkeys((*PLANT_VECTORS, MEAN_METABOLIC_RATES), JointState),
    **dict.fromkeys(PICTURES, Image),
}
EPISODE = Episode(
    phase=TRAINING,
    test=-1,
    trial=-1,
    episode=4,
    training_iteration=40,
    stimulus=1,
    object_distance_m=1.5,
    activations=pair_activations(0.05, 0.02),
    n_iterations=3,
    first_observation=44,
)
COMMANDS = ([0.06, 0.01], [0.03, 0.02], [0.0, 0.0])


def plant_bench(graph: Graph, pictures: Path, **parameters: Any) -> Bench:
    """Return a plant with small stimuli, and those who talk to it."""
    small = {"stimuli__directory": str(pictures), "stimuli__size_px": 64}
    plant = graph.add(EyePlantNode, **(small | parameters))
    return Bench(graph, plant, {"muscle_command": JointState}, HEARD)


def begin(bench: Bench, **changes: Any) -> tuple[bool, str]:
    return bench.request("episode", **(EPISODE.as_arguments() | changes))


def send_command(
    bench: Bench,
    observation: int,
    values: Any = (0.05, 0.05),
    names: Any = ("medial_rectus", "lateral_rectus"),
) -> None:
    bench.outsider.send("muscle_command", vector_message(observation * PERIOD_NS, names, values))


def observation_numbers(bench: Bench, topic: str) -> list[int]:
    """Return the observation numbers of what was heard on a topic."""
    return [stamp_ns // PERIOD_NS for stamp_ns in bench.outsider.stamps_ns(topic)]


def wait_for(bench: Bench, number: int, topic: str = "ground_truth") -> None:
    """Wait until an observation is heard on a topic."""
    bench.graph.spin_until(
        lambda: number in observation_numbers(bench, topic), f"observation {number} on {topic}"
    )


def distinct_numbers(bench: Bench, topic: str) -> list[int]:
    return list(dict.fromkeys(observation_numbers(bench, topic)))


def run_episode(bench: Bench) -> None:
    assert begin(bench) == (True, "")
    for i, command in enumerate(COMMANDS):
        bench.wait_distinct("eye_states", i + 1)
        send_command(bench, 44 + i, command)
    for topic in HEARD:
        bench.wait_distinct(topic, 3 if topic in PICTURES else 4)
