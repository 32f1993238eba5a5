"""The node sparse_coder: one answer per observation, learned from once, and what is refused."""

import array
import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from sensor_msgs.msg import Image, JointState

from lockstep.errors import InputError
from lockstep.wire.stamps import to_time
from lockstep.wire.topics import EPISODE_NAMES, PICTURES, REWARD_NAMES, TEST, TRAINING
from lockstep.wire.vectors import vector_message
from sparse_coder.coder import SparseCoder
from sparse_coder.config import SparseCoderConfig
from sparse_coder.node import INPUTS, SparseCoderNode
from tests.node_harness import Bench, Graph, ros_graph
from tests.pair import HORIZONTAL_RECTI
from tests.stamps import to_ns

CONFIG = SparseCoderConfig(n_bases=16, metabolic_cost_weight=0.1)
RATES_W = (0.5, 0.25, 0.125, 1.0)


@pytest.fixture
def graph() -> Iterator[Graph]:
    """Yield a domain of the test's own."""
    with ros_graph() as graph:
        yield graph


def _bench(graph: Graph) -> Bench:
    node = graph.add(SparseCoderNode, n_bases=16, metabolic_cost_weight=0.1)
    return Bench(graph, node, INPUTS, {"features": Image, "reward": JointState})


@pytest.fixture
def bench(graph: Graph) -> Bench:
    """Return a small coder whose run has started."""
    bench = _bench(graph)
    assert bench.request("start_run") == (True, "")
    return bench


def _picture(number: int, side: int) -> np.ndarray:
    draw = np.random.default_rng((number, side))
    return draw.integers(0, 256, (240, 320), dtype=np.uint8)


def _picture_message(picture: np.ndarray, stamp_ns: int, **changes: Any) -> Image:
    height, width = picture.shape
    message = Image(height=height, width=width, step=width, encoding="mono8")
    message.header.stamp = to_time(stamp_ns)
    message.data = array.array("B", picture.tobytes())
    for name, value in changes.items():
        setattr(message, name, value)
    return message


def _observation(number: int, phase: int = TRAINING, stamp_ns: int | None = None) -> dict[str, Any]:
    """Return the messages of an observation, by topic; the stamp is the number in seconds."""
    stamp_ns = number * 10**9 if stamp_ns is None else stamp_ns
    episode = dict.fromkeys(EPISODE_NAMES, 0.0) | {"phase": phase, "observation": number}
    messages: dict[str, Any] = {
        topic: _picture_message(_picture(number, side), stamp_ns)
        for side, topic in enumerate(PICTURES)
    }
    messages["episode"] = vector_message(stamp_ns, tuple(episode), tuple(episode.values()))
    messages["muscle_activations"] = vector_message(
        stamp_ns, ("left_superior_rectus", *HORIZONTAL_RECTI), (0.1,) * 5, effort=(9.0, *RATES_W)
    )
    return messages


def _show(bench: Bench, messages: dict[str, Any]) -> None:
    for topic, message in messages.items():
        bench.outsider.send(topic, message)


def _steps(bench: Bench) -> int:
    return int(bench.node.learner.learning_steps)


def test_features_and_reward_are_the_coders(bench: Bench) -> None:
    coder = SparseCoder(CONFIG)
    for number in (1, 2, 3):
        _show(bench, _observation(number))
        features = bench.wait_distinct("features", number)[-1]
        values = bench.wait_distinct("reward", number)[-1]
        encoding = coder.encode(_picture(number, 0), _picture(number, 1))
        assert to_ns(features.header.stamp) == to_ns(values.header.stamp) == number * 10**9
        assert (features.height, features.width, features.step) == (2, 16, 64)
        assert features.encoding == "32FC1"
        assert bytes(features.data) == encoding.features.tobytes()
        coarse, fine = encoding.reconstruction_error.tolist()
        assert tuple(values.name) == REWARD_NAMES
        rate_w = 1.875
        expected = [coarse, fine, rate_w, -(coarse + fine) - 0.1 * rate_w, number - 1]
        assert list(values.position) == pytest.approx(expected, rel=1e-12)
        assert list(values.position)[:3] == expected[:3]
        coder.learn(encoding)
    bench.graph.spin_until(lambda: _steps(bench) == 3, "the third lesson")
    assert bench.node.learner.atoms().tobytes() == coder.atoms().tobytes()


def test_who_subscribes_is_shown_the_basis_functions(graph: Graph) -> None:
    node = graph.add(SparseCoderNode, n_bases=16)
    bench = Bench(graph, node, INPUTS, {"basis_functions": Image})
    assert bench.request("start_run") == (True, "")
    _show(bench, _observation(1))
    message = bench.wait_distinct("basis_functions", 1)[0]
    assert (message.height, message.width, message.encoding) == (32, 128, "32FC1")
    assert bytes(message.data) == SparseCoder(SparseCoderConfig(n_bases=16)).atoms().tobytes()


def test_the_same_observation_is_answered_again_and_learned_from_once(bench: Bench) -> None:
    for _ in range(3):
        _show(bench, _observation(1))
    features, rewards = bench.wait_heard("features", 3), bench.wait_heard("reward", 3)
    assert features[0] == features[1] == features[2]
    assert rewards[0] == rewards[1] == rewards[2]
    assert _steps(bench) == 1


def test_an_older_observation_is_ignored(bench: Bench) -> None:
    _show(bench, _observation(5))
    bench.wait_heard("reward", 1)
    _show(bench, _observation(4))
    _show(bench, _observation(6))
    bench.wait_distinct("reward", 2)
    assert bench.outsider.stamps_ns("reward") == [5 * 10**9, 6 * 10**9]
    bench.graph.spin_until(lambda: _steps(bench) == 2, "the second lesson")


def test_topics_in_any_order(bench: Bench) -> None:
    orders: tuple[Callable[..., Any], ...] = (reversed, sorted)
    for number, order in enumerate(orders, start=1):
        messages = _observation(number)
        _show(bench, {topic: messages[topic] for topic in order(list(messages))})
        bench.wait_distinct("features", number)
    assert bench.node.diagnostics.n_refused == 0


def test_tests_are_answered_and_not_learned_from(bench: Bench) -> None:
    before = bench.node.learner.atoms().tobytes()
    for number in (1, 2):
        _show(bench, _observation(number, TEST))
        bench.wait_distinct("features", number)
    assert _steps(bench) == 0
    assert bench.node.learner.atoms().tobytes() == before


def test_a_saved_state_goes_on_bit_for_bit(bench: Bench, tmp_path: Path) -> None:
    path = tmp_path / "state.npz"
    _show(bench, _observation(1))
    bench.graph.spin_until(lambda: _steps(bench) == 1, "a lesson")
    assert bench.request("save", path=str(path)) == (True, "")
    _show(bench, _observation(2))
    bench.graph.spin_until(lambda: _steps(bench) == 2, "the second lesson")
    expected = bench.node.learner.atoms().tobytes()
    assert bench.request("end_run") == (True, "")
    # Another run begins untrained, and its stamps at 0.
    assert bench.request("start_run", run_id="next") == (True, "")
    assert _steps(bench) == 0
    assert bench.request("load", run_id="next", path=str(path)) == (True, "")
    assert _steps(bench) == 1
    _show(bench, _observation(2, stamp_ns=0))
    bench.graph.spin_until(lambda: _steps(bench) == 2, "the second lesson again")
    assert bench.node.learner.atoms().tobytes() == expected


@pytest.mark.parametrize("damage", ["missing", "cut off", "foreign", "of another size"])
def test_a_bad_state_is_refused_and_changes_nothing(
    bench: Bench, tmp_path: Path, damage: str
) -> None:
    from lockstep.state_file import write_state

    path = tmp_path / "state.npz"
    kind = "vergence_rl" if damage == "foreign" else "sparse_coder"
    n_bases = 8 if damage == "of another size" else 16
    if damage != "missing":
        write_state(path, kind, SparseCoder(SparseCoderConfig(seed=5, n_bases=n_bases)).state())
    if damage == "cut off":
        path.write_bytes(path.read_bytes()[:-40])
    before = bench.node.learner.atoms().tobytes()
    successful, reason = bench.request("load", path=str(path))
    assert not successful
    assert str(path) in reason
    assert bench.node.learner.atoms().tobytes() == before


def test_a_state_that_cannot_be_saved_is_refused(bench: Bench, tmp_path: Path) -> None:
    successful, reason = bench.request("save", path=str(tmp_path / "no_directory" / "state.npz"))
    assert not successful
    assert "cannot be written" in reason
    for arguments in ({}, {"path": ""}, {"path": 3}, {"path": "a", "more": 1}):
        assert "expected the path of a state file" in bench.request("save", **arguments)[1]


def _changed(topic: str, **changes: Any) -> Callable[[dict[str, Any]], None]:
    def change(messages: dict[str, Any]) -> None:
        for name, value in changes.items():
            setattr(messages[topic], name, value)

    return change


def _small(messages: dict[str, Any]) -> None:
    messages["left/image_raw"] = _picture_message(np.zeros((20, 30), np.uint8), 10**9)


def _unequal(messages: dict[str, Any]) -> None:
    messages["left/image_raw"] = _picture_message(np.zeros((242, 320), np.uint8), 10**9)


_NAN_RATE = array.array("d", [9.0, math.nan, 0.0, 0.0, 0.0])


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (_changed("left/image_raw", encoding="rgb8"), "left/image_raw: expected a mono8 image"),
        (_changed("right/image_raw", encoding=""), "right/image_raw: expected a mono8 image"),
        (
            _changed("left/image_raw", height=239),
            "left/image_raw: expected a mono8 image of height",
        ),
        (_changed("left/image_raw", step=319), "left/image_raw: expected a mono8 image of height"),
        (_changed("left/image_raw", width=2**32 - 1), "left/image_raw: expected a mono8 image of"),
        (_changed("left/image_raw", data=array.array("B")), "left/image_raw: expected a mono8"),
        (_small, "expected"),
        (_unequal, "expected"),
        (_changed("episode", name=["phase"]), "episode: expected one position per name"),
        (_changed("episode", name=["x"] * 7), "episode: expected each name once, got x twice"),
        (
            _changed("episode", position=array.array("d", [0.5] * 7)),
            "episode: expected whole numbers from 0 to 2^53 as phase, got [0.5]",
        ),
        (
            _changed("muscle_activations", effort=array.array("d")),
            "muscle_activations: expected one effort per name, got 0 for 5 names",
        ),
        (
            _changed("muscle_activations", effort=_NAN_RATE),
            "muscle_activations: expected finite values, got effort",
        ),
    ],
)
def test_a_bad_observation_is_refused_and_the_good_one_answered(
    bench: Bench, change: Callable[[dict[str, Any]], None], reason: str
) -> None:
    messages = _observation(1)
    change(messages)
    _show(bench, messages)
    assert reason in bench.wait_refused(1)
    assert _steps(bench) == 0
    # The same stamp, repeated whole, is still to be answered, and then learned from once.
    _show(bench, _observation(1))
    features = bench.wait_distinct("features", 1)[0]
    expected = SparseCoder(CONFIG).encode(_picture(1, 0), _picture(1, 1)).features
    assert bytes(features.data) == expected.tobytes()
    bench.wait_heard("reward", 1)
    bench.graph.spin_until(lambda: _steps(bench) == 1, "a lesson")
    assert len(bench.outsider.heard["reward"]) == 1


def test_impossible_stamps_are_refused(bench: Bench) -> None:
    messages = _observation(1)
    for sec, nanosec in ((-1, 0), (-1, 999_999_999), (0, 10**9)):
        for message in messages.values():
            message.header.stamp.sec, message.header.stamp.nanosec = sec, nanosec
        _show(bench, messages)
    assert "stamp: expected sec >= 0" in bench.wait_refused(3 * len(messages))
    assert bench.outsider.heard["features"] == []


def test_stamps_of_the_far_future_block_nobody(bench: Bench) -> None:
    messages = _observation(7)
    for topic in ("episode", "left/image_raw"):
        messages[topic].header.stamp.sec = 2**31 - 1
        bench.outsider.send(topic, messages[topic])
    _show(bench, _observation(1))
    bench.wait_distinct("features", 1)
    assert bench.outsider.stamps_ns("features") == [10**9]


def test_untrained_it_answers_without_a_run(graph: Graph) -> None:
    bench = _bench(graph)
    _show(bench, _observation(1))
    bench.wait_distinct("features", 1)


def test_it_never_hears_the_ground_truth(bench: Bench) -> None:
    assert set(INPUTS) == {*PICTURES, "episode", "muscle_activations"}
    heard = {name for name, _ in bench.node.get_subscriber_names_and_types_by_node(bench.name, "/")}
    assert {name.lstrip("/") for name in heard} == set(INPUTS)


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"n_bases": 0}, "n_bases: expected 1 or more, got 0"),
        ({"n_bases": 4.5}, "n_bases: expected an integer, got 4.5"),
        ({"learning_rate": math.nan}, "learning_rate: expected 0 or more, got nan"),
        ({"n_base": 400}, "unknown parameter n_base"),
    ],
)
def test_a_bad_configuration(graph: Graph, parameters: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        graph.add(SparseCoderNode, **parameters)
