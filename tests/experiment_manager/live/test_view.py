"""What a viewer is shown, by a real server and a real client of its protocol."""

import json
import re
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from experiment_manager.live import server as server_module
from experiment_manager.live.page import LAYOUT, Page
from experiment_manager.live.server import NoServer, ViewServer, why_unavailable
from experiment_manager.live.shown import Shown
from experiment_manager.live.steering import Steering
from experiment_manager.live.view import (
    ANAGLYPH,
    LEARNING,
    LEARNING_NAMES,
    RECONSTRUCTIONS,
    SHOWN_TOPICS,
    RunningError,
    View,
    compared,
    open_server,
)
from lockstep import MUSCLE_NAMES, InputError
from lockstep.wire.topics import (
    BASIS_FUNCTIONS,
    EYE_STATE_NAMES,
    GAZE_TARGET,
    GROUND_TRUTH_NAMES,
    PICTURES,
    VECTOR,
    reward_names,
)
from sparse_coder import SparseCoder, SparseCoderConfig
from sparse_coder.picture_of_code import reconstructed_windows, seen_windows
from tests.foxglove_client import FoxgloveClient
from tests.pair import ACTOR_CRITIC_NAMES, COMMAND_NAMES
from tests.patience import PATIENCE_S

NAMES = {
    "muscle_command": COMMAND_NAMES,
    "ground_truth": GROUND_TRUTH_NAMES,
    "reward": reward_names(),
    "actor_critic": ACTOR_CRITIC_NAMES,
    "eye_states": EYE_STATE_NAMES,
    "muscle_activations": MUSCLE_NAMES,
}


@pytest.fixture
def server() -> Iterator[ViewServer]:
    """Return a server on a free port."""
    server = open_server("127.0.0.1", 0, print)
    assert isinstance(server, ViewServer)
    yield server
    server.close()


def _truth(**values: float) -> list[float]:
    return [values.get(name, 0.0) for name in GROUND_TRUTH_NAMES]


def _picture(seed: int) -> np.ndarray:
    return np.random.default_rng(seed).integers(0, 256, (240, 320), dtype=np.uint8)


def test_what_is_watched_is_sent_as_it_is_and_made_into_pictures(server, vector_bytes, image_bytes):
    view = View(server, n_selections=10)
    left, right = _picture(1), _picture(2)
    messages = {
        "left/image_raw": image_bytes(left, 7),
        "right/image_raw": image_bytes(right, 7),
        "reward": vector_bytes(reward_names(), [0.1, 0.2, 1.0, 0.0, -0.3, 5.0], 7),
    }
    coder = SparseCoder(SparseCoderConfig(n_bases=16, seed=3))
    view.take_basis_functions(coder.atoms().reshape(32, 128))
    for iteration in (9, 10):
        truth = _truth(iteration=iteration, training_iteration=iteration, vergence_error_deg=-0.5)
        view.count(vector_bytes(GROUND_TRUTH_NAMES, truth, 7))
    topics = [f"/{t}" for t in (*messages, ANAGLYPH, *RECONSTRUCTIONS, LEARNING)]
    with FoxgloveClient(server.port) as client:
        client.subscribe(topics)
        while not all(server.is_watched(topic.removeprefix("/")) for topic in topics):
            pass
        view.show(messages)
        client.receive_of_each(topics)
    got = {topic.removeprefix("/"): messages[0] for topic, messages in client.received.items()}
    for topic, message in messages.items():
        assert got[topic] == message
    assert np.stack([left, right, right], axis=-1).tobytes() in got[ANAGLYPH]
    encoding = coder.encode(left, right)
    reconstructed = reconstructed_windows(encoding, coder.atoms(), left, right)
    for topic, input_windows, of_reconstruction in zip(
        RECONSTRUCTIONS, seen_windows(left, right), reconstructed, strict=True
    ):
        assert compared(input_windows, of_reconstruction).tobytes() in got[topic]
    assert json.loads(got[LEARNING]) == dict(zip(LEARNING_NAMES, (10.0, 0.5), strict=True))


def test_nothing_is_made_or_sent_of_what_nobody_watches(server, image_bytes) -> None:
    view = View(server, n_selections=10)
    assert view.wanted_topics() == {"ground_truth"}
    view.show({topic: image_bytes(_picture(1), 7) for topic in PICTURES})
    with FoxgloveClient(server.port) as client:
        client.subscribe([f"/{RECONSTRUCTIONS[1]}"])
        while not server.is_watched(RECONSTRUCTIONS[1]):
            pass
        assert view.wanted_topics() == {"ground_truth", *PICTURES, BASIS_FUNCTIONS}


def test_a_head_that_does_not_know_its_error_has_no_running_one(vector_bytes) -> None:
    view = View(NoServer(), n_selections=10)
    truth = _truth(iteration=10, training_iteration=10, vergence_error_deg=np.nan)
    view.count(vector_bytes(GROUND_TRUTH_NAMES, truth, 7))
    view.show({})
    assert view.learning is None


def test_the_channels_carry_the_definitions_of_their_messages(server: ViewServer) -> None:
    with FoxgloveClient(server.port) as client:
        for topic, kind in SHOWN_TOPICS.items():
            channel = client.channels[f"/{topic}"]
            assert (channel["encoding"], channel["schemaEncoding"]) == ("cdr", "ros2msg")
            assert channel["schemaName"] == kind
            assert "MSG: std_msgs/Header" in channel["schema"]
        assert client.channels[f"/{ANAGLYPH}"]["schemaName"] == "foxglove.RawImage"


def test_the_running_error_is_the_median_at_the_ends_of_training_episodes() -> None:
    running = RunningError()
    for episode, end_deg in enumerate((-1.0, 3.0, 2.0)):
        for iteration in range(11):
            error_deg = end_deg if iteration == 10 else 9.0
            running.add(iteration, 10 * episode + iteration, error_deg)
    assert running.is_new
    assert running.numbers() == (30.0, 2.0)
    assert not running.is_new


def test_an_episode_whose_end_was_not_heard_does_not_count() -> None:
    running = RunningError()
    for iteration, error_deg in ((10, 1.0), (4, 7.0), (0, 8.0), (10, 2.0)):
        running.add(iteration, iteration, error_deg)
    assert running.numbers()[1] == 1.5


def test_compared_shows_the_input_above_the_reconstruction() -> None:
    seen = np.stack([np.full((2, 2), 10.0), np.full((2, 2), 20.0)])
    picture = compared(seen, np.stack([np.full((2, 2), -5.0), np.full((2, 2), 300.4)]))
    expected = np.kron([[10, 10, 20, 20]] * 2 + [[0, 0, 255, 255]] * 2, np.ones((4, 4)))
    np.testing.assert_array_equal(picture, expected)


def test_a_port_in_use_is_one_error(server: ViewServer) -> None:
    with pytest.raises(InputError, match=rf"cannot listen on 127.0.0.1:{server.port}.*in use"):
        open_server("127.0.0.1", server.port, print)
    with pytest.raises(InputError, match=rf"cannot listen on 127.0.0.1:{server.port}"):
        Page("127.0.0.1", server.port, "ws://127.0.0.1:1", Steering(Shown(1.0)))


def test_without_the_sdk_the_command_that_installs_it_is_told(monkeypatch) -> None:
    monkeypatch.setattr(server_module.importlib.util, "find_spec", lambda name: None)
    command = why_unavailable().partition(": ")[2]
    assert command.startswith(".venv/bin/python -m pip install --require-hashes -r ")
    assert "foxglove-sdk==" in Path(command.split()[-1]).read_text()
    assert isinstance(open_server("127.0.0.1", 0, print), NoServer), "the page works without it"


def test_the_page_has_links_to_open_the_view_and_serves_the_layout() -> None:
    page = Page("127.0.0.1", 0, "ws://127.0.0.1:8765", Steering(Shown(1.0)))
    address = f"http://127.0.0.1:{page.port}"
    with urllib.request.urlopen(f"{address}/", timeout=PATIENCE_S) as answer:
        text = answer.read().decode()
    assert re.findall(r'href="(\w+)://[^"]*ds.url=ws%3A%2F%2F127.0.0.1%3A8765"', text)
    assert text.index("Lichtblick") < text.index("in Foxglove")
    with urllib.request.urlopen(f"{address}/layout.json", timeout=PATIENCE_S) as answer:
        assert answer.read() == LAYOUT.read_bytes()
    with pytest.raises(urllib.request.HTTPError, match="404"):
        urllib.request.urlopen(f"{address}/../config.py", timeout=PATIENCE_S)
    page.close()


def test_the_layout_has_a_message_prepared_that_says_where_to_look() -> None:
    panel = json.loads(LAYOUT.read_text())["configById"]["Publish!gaze_target"]
    assert (panel["topicName"], panel["datatype"]) == (f"/{GAZE_TARGET}", VECTOR)
    steering = Steering(Shown(1.0))
    steering.ask(panel["value"].encode())
    np.testing.assert_array_equal(np.array(steering.take()), [5.0, 0.0])


LAYOUT_OF_BAGS = Path(__file__).parents[3] / "docs" / "foxglove_layout.json"


def _panels(tree: Any) -> Iterator[str]:
    if isinstance(tree, str):
        yield tree
    else:
        yield from _panels(tree["first"])
        yield from _panels(tree["second"])


OF_EYES = {*PICTURES, "features"}


@pytest.mark.parametrize(
    ("file", "shown", "series"),
    [
        (LAYOUT, OF_EYES | {ANAGLYPH, *RECONSTRUCTIONS}, {"running_median_error_deg", "reward"}),
        (LAYOUT_OF_BAGS, OF_EYES, {"vergence_error_deg", "reward", "right_lateral_rectus"}),
    ],
    ids=["live", "bags"],
)
def test_each_panel_of_a_layout_shows_what_its_label_says(
    file: Path, shown: set[str], series: set[str]
) -> None:
    layout = json.loads(file.read_text())
    panels = layout["configById"]
    assert sorted(_panels(layout["layout"])) == sorted(panels)
    pictures = {p["imageMode"]["imageTopic"] for p in panels.values() if "imageMode" in p}
    assert pictures == {f"/{topic}" for topic in shown}
    paths = [path for panel in panels.values() for path in panel.get("paths", ())]
    for path in paths:
        match = re.fullmatch(r"/(\w+)\.(?:position|effort)\[(\d+)\]", path["value"])
        if match is None:
            assert path["value"] == f"/{LEARNING}.{path['label']}"
            assert path["label"] in LEARNING_NAMES
        else:
            assert NAMES[match[1]][int(match[2])] == path["label"]
    assert series <= {path["label"] for path in paths}
