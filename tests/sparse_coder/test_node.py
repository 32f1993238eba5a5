"""The node sparse_coder: one answer per observation, learned from once, and what is refused."""

import array
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from sensor_msgs.msg import Image, JointState

from lockstep import SIDES
from lockstep.wire.topics import EPISODE_NAMES, PICTURES, TRAINING, reward_names
from lockstep.wire.vectors import vector_message
from sparse_coder import SparseCoder, SparseCoderConfig
from sparse_coder.node import INPUTS, SparseCoderNode
from tests.learner_contract import LearnerBench, LearnerContract, changed, image_message
from tests.node_harness import Graph
from tests.pair import HORIZONTAL_RECTI
from tests.stamps import to_ns

CONFIG = SparseCoderConfig(n_bases=16, metabolic_cost_weight=0.1)
RATES_W = (0.5, 0.25, 0.125, 1.0)


@pytest.fixture
def bench(graph: Graph) -> LearnerBench:
    node = graph.add(SparseCoderNode, n_bases=16, metabolic_cost_weight=0.1)
    answers = {"features": Image, "reward": JointState}
    return LearnerBench(graph, node, INPUTS, answers, _observation, refused=REFUSED)


class TestContract(LearnerContract):
    """Of all learners."""


def _picture(number: int, side: int) -> np.ndarray:
    draw = np.random.default_rng((number, side))
    return draw.integers(0, 256, (240, 320), dtype=np.uint8)


def _observation(number: int, phase: int = TRAINING) -> dict[str, Any]:
    """Return the messages of an observation, by topic; the stamp is the number in seconds."""
    stamp_ns = number * 10**9
    episode = dict.fromkeys(EPISODE_NAMES, 0.0) | {"phase": phase, "observation": number}
    messages: dict[str, Any] = {
        topic: image_message(_picture(number, side), "mono8", stamp_ns)
        for side, topic in enumerate(PICTURES)
    }
    messages["episode"] = vector_message(stamp_ns, tuple(episode), tuple(episode.values()))
    messages["muscle_activations"] = vector_message(
        stamp_ns, ("left_superior_rectus", *HORIZONTAL_RECTI), (0.1,) * 5, effort=(9.0, *RATES_W)
    )
    return messages


def test_features_and_reward_are_the_coders(bench: LearnerBench) -> None:
    coder = SparseCoder(CONFIG)
    for number in (1, 2, 3):
        bench.show(number)
        features = bench.wait_distinct("features", number)[-1]
        values = bench.wait_distinct("reward", number)[-1]
        encoding = coder.encode(_picture(number, 0), _picture(number, 1))
        assert to_ns(features.header.stamp) == to_ns(values.header.stamp) == number * 10**9
        assert (features.height, features.width, features.step) == (2, 16, 64)
        assert features.encoding == "32FC1"
        assert bytes(features.data) == encoding.features.tobytes()
        coarse, fine = encoding.reconstruction_error.tolist()
        assert tuple(values.name) == reward_names()
        rate_w = 1.875
        penalty = 0.1 * rate_w
        expected = [coarse, fine, rate_w, penalty, -(coarse + fine) - penalty, number - 1]
        assert list(values.position) == pytest.approx(expected, rel=1e-12)
        assert list(values.position)[:3] == expected[:3]
        coder.learn(encoding)
    bench.wait_learned(3)
    assert bench.node.learner.atoms().tobytes() == coder.atoms().tobytes()


def test_who_subscribes_is_shown_the_basis_functions(graph: Graph) -> None:
    node = graph.add(SparseCoderNode, n_bases=16)
    bench = LearnerBench(graph, node, INPUTS, {"basis_functions": Image}, _observation)
    bench.show(1)
    message = bench.wait_distinct("basis_functions", 1)[0]
    assert (message.height, message.width, message.encoding) == (32, 128, "32FC1")
    assert bytes(message.data) == SparseCoder(SparseCoderConfig(n_bases=16)).atoms().tobytes()


def _of_size(height: int, width: int) -> Callable[[dict[str, Any]], None]:
    def change(messages: dict[str, Any]) -> None:
        picture = np.zeros((height, width), np.uint8)
        messages["left/image_raw"] = image_message(picture, "mono8", 10**9)

    return change


_NAN_RATE = array.array("d", [9.0, math.nan, 0.0, 0.0, 0.0])


REFUSED = [
    (changed("left/image_raw", encoding="rgb8"), "left/image_raw: expected an image of mono8"),
    (changed("right/image_raw", encoding=""), "right/image_raw: expected an image of mono8"),
    (
        changed("left/image_raw", height=239),
        "left/image_raw: expected an image of mono8",
    ),
    (changed("left/image_raw", step=319), "left/image_raw: expected an image of mono8"),
    (changed("left/image_raw", width=2**32 - 1), "left/image_raw: expected an image of mono8"),
    (
        changed("left/image_raw", data=array.array("B")),
        "left/image_raw: expected an image of mono8",
    ),
    (_of_size(20, 30), "left image: expected even sides of at least 128 px"),
    (_of_size(242, 320), "images: expected one size for both eyes"),
    (
        changed("episode", position=array.array("d", [0.5] * 7)),
        "episode: expected whole numbers from 0 to 2^53 as phase, iteration, ",
    ),
    (
        changed("muscle_activations", effort=_NAN_RATE),
        "muscle_activations: expected finite values, got ",
    ),
]


def test_a_scale_with_pictures_of_its_own_waits_for_them(graph: Graph) -> None:
    lists = {
        "names": ["fine", "foveal"],
        "window_px": [40, 40],
        "size_px": [40, 40],
        "zoom": [1.0, 4.0],
        "focus_d": [0.0, 0.0],
    }
    own = {f"{side}/foveal/image_raw": Image for side in SIDES}
    node = graph.add(SparseCoderNode, n_bases=16, **{f"scales__{n}": v for n, v in lists.items()})
    assert node.inputs() == INPUTS | own
    foveal = np.stack([_picture(7, side)[:40, :40] for side in range(2)])

    def observation(number: int, phase: int = TRAINING) -> dict[str, Any]:
        pairs = zip(own, foveal, strict=True)
        return _observation(number, phase) | {
            topic: image_message(picture, "mono8", number * 10**9) for topic, picture in pairs
        }

    bench = LearnerBench(
        graph, node, INPUTS | own, {"features": Image, "reward": JointState}, observation
    )
    bench.show(1)
    message = bench.wait_distinct("features", 1)[0]
    coder = SparseCoder(node.config)
    expected = coder.encode(_picture(1, 0), _picture(1, 1), [foveal]).features
    assert bytes(message.data) == expected.tobytes()
    assert bench.wait_distinct("reward", 1)[0].name[1] == "reconstruction_error_foveal"
