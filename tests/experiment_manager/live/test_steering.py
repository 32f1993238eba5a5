"""A click in the page's picture and a viewer's message become the topic gaze_target."""

import json
import math
import socket
import urllib.request
from collections.abc import Callable
from urllib.error import HTTPError

import cv2
import numpy as np
import pytest
from rclpy.node import Node
from sensor_msgs.msg import Image, JointState

from experiment_manager.live.node import LiveViewNode
from experiment_manager.live.page import Page
from experiment_manager.live.shown import Shown
from experiment_manager.live.steering import Steering
from lockstep import InputError
from lockstep.wire.topics import GAZE_TARGET, PICTURES, TARGET_NAMES
from tests.foxglove_client import FoxgloveClient
from tests.node_harness import Graph
from tests.patience import PATIENCE_S

F_PX = 100.0
PICTURE = np.arange(240 * 320, dtype=np.uint32).reshape(240, 320).astype(np.uint8)
# The picture is drawn larger, so that a click in it is nearer to the line of sight.
OPTICS = {"camera.focal_length_px": F_PX / 1.25, "camera.left_magnification": 1.25}
THERE = {"name": ["target_up_deg", "target_sideways_deg"], "position": [-2.0, 5.0]}


@pytest.fixture
def steering() -> Steering:
    steering = Steering(Shown(F_PX))
    steering.shown.show([PICTURE])
    return steering


def _taken(steering: Steering) -> list[float]:
    target_deg = steering.take()
    assert target_deg is not None
    return [float(angle_deg) for angle_deg in target_deg]


@pytest.mark.parametrize(
    ("column_px", "row_px", "sideways_deg", "up_deg"),
    [
        (160.0, 120.0, 0.0, 0.0),
        (260.0, 120.0, 45.0, 0.0),
        (160.0, 20.0, 0.0, 45.0),
        # 30 px and 40 px aside make 50 px; atan(50 / 100), shared as 3 to 4.
        (130.0, 160.0, -0.6 * math.degrees(math.atan(0.5)), -0.8 * math.degrees(math.atan(0.5))),
    ],
)
def test_a_click_is_an_angle_from_the_centre(
    steering: Steering, column_px, row_px, sideways_deg, up_deg
) -> None:
    steering.ask_at(column_px, row_px)
    np.testing.assert_allclose(_taken(steering), [sideways_deg, up_deg], atol=1e-12)
    assert steering.take() is None


def test_the_newest_message_counts_and_names_say_which_number_is_which(steering: Steering) -> None:
    steering.ask_at(0.0, 0.0)
    steering.ask(json.dumps(THERE).encode())
    assert _taken(steering) == [5.0, -2.0]


@pytest.mark.parametrize(
    "message",
    [
        b"\xff",
        b"[]",
        b"{}",
        b'{"name": 1, "position": 2}',
        b'{"name": ["target_up_deg"], "position": [1.0]}',
        b'{"name": ["target_sideways_deg", "target_up_deg"], "position": ["a", 1.0]}',
        b'{"name": ["target_sideways_deg", "target_up_deg"], "position": [NaN, 1.0]}',
    ],
)
def test_a_message_that_is_no_target_is_one_error(steering: Steering, message: bytes) -> None:
    steering.ask(message)
    with pytest.raises(InputError, match=GAZE_TARGET):
        steering.take()
    assert steering.take() is None


def _page(steering: Steering) -> tuple[Page, str]:
    page = Page("127.0.0.1", 0, "ws://127.0.0.1:1", steering)
    return page, f"http://127.0.0.1:{page.port}"


def _click(address: str, query: str, **headers: str) -> int:
    request = urllib.request.Request(f"{address}/look?{query}", method="POST", headers=headers)
    with urllib.request.urlopen(request, timeout=PATIENCE_S) as answer:
        return int(answer.status)


def test_the_page_shows_the_picture_and_takes_clicks(steering: Steering) -> None:
    page, address = _page(steering)
    is_watched: bool = steering.shown.is_watched
    assert not is_watched
    with urllib.request.urlopen(f"{address}/left.png?1", timeout=PATIENCE_S) as answer:
        seen = cv2.imdecode(np.frombuffer(answer.read(), np.uint8), cv2.IMREAD_GRAYSCALE)
    np.testing.assert_array_equal(seen, PICTURE)
    is_watched = steering.shown.is_watched
    assert is_watched
    assert _click(address, "column_px=260&row_px=120") == 204
    np.testing.assert_allclose(_taken(steering), [45.0, 0.0])
    for query, reason in (
        ("column_px=1", "expected a number as column_px and one as row_px"),
        ("column_px=a&row_px=1", "expected a number"),
        ("", "expected a number"),
        ("column_px=9999&row_px=1", "image of 320 x 240 px, got column 9999 and row 1"),
        ("column_px=1&row_px=-0.5", "got column 1 and row -0.5"),
        ("column_px=nan&row_px=1", "got column nan"),
    ):
        with pytest.raises(HTTPError, match=f"400: .*{reason}"):
            _click(address, query)
    assert steering.take() is None
    page.close()


def test_pages_of_others_neither_steer_nor_see(steering: Steering) -> None:
    page, address = _page(steering)
    here = address.partition("://")[2]
    middle = "column_px=160&row_px=120"
    assert _click(address, middle, Origin=address) == 204
    assert (
        _click(
            address, middle, Origin=f"http://LOCALHOST:{page.port}", Host=f"localhost:{page.port}"
        )
        == 204
    )
    assert _click(address, middle, Host=f"{socket.gethostname()}:{page.port}") == 204
    steering.take()
    for headers in (
        {"Origin": "https://example.org"},
        {"Origin": "null"},
        {"Origin": f"http://127.0.0.1:{page.port + 1}"},
        # A name of theirs that leads here (DNS rebinding).
        {"Origin": f"http://example.org:{page.port}", "Host": f"example.org:{page.port}"},
        {"Host": "example.org"},
        {"Host": "[::1"},
    ):
        with pytest.raises(HTTPError, match=r"403: .*expected"):
            _click(address, middle, **headers)
    assert steering.take() is None
    with pytest.raises(HTTPError, match=r"403: .*127\.0\.0\.1 or this machine as Host, got evil"):
        urllib.request.urlopen(
            urllib.request.Request(f"{address}/left.png", headers={"Host": "evil"}),
            timeout=PATIENCE_S,
        )
    with urllib.request.urlopen(f"http://{here}/left.png", timeout=PATIENCE_S) as answer:
        assert "Access-Control-Allow-Origin" not in answer.headers
    page.close()


def test_the_page_listens_on_ipv6(steering: Steering) -> None:
    try:
        page = Page("::1", 0, "ws://[::1]:1", steering)
    except InputError:
        pytest.skip("no IPv6 here")
    assert _click(f"http://[::1]:{page.port}", "column_px=160&row_px=120") == 204
    page.close()


def test_before_the_first_picture_there_is_nothing_to_click_in() -> None:
    page, address = _page(Steering(Shown(F_PX)))
    with pytest.raises(HTTPError, match="404"):
        urllib.request.urlopen(f"{address}/left.png", timeout=PATIENCE_S)
    with pytest.raises(HTTPError, match="400"):
        _click(address, "column_px=1&row_px=1")
    page.close()


def test_a_viewer_and_the_page_steer_through_the_real_node(
    graph: Graph, image_bytes: Callable[..., bytes]
) -> None:
    live = graph.add(LiveViewNode, port=0, page_port=0, **OPTICS)
    other = graph.add(lambda **kwargs: Node("other", **kwargs))
    targets: list[JointState] = []
    other.create_subscription(JointState, GAZE_TARGET, targets.append, 10)
    pictures = other.create_publisher(Image, PICTURES[0], 10)
    graph.spin_until(lambda: other.count_publishers(GAZE_TARGET), "the node's publisher")
    ws_port, page_port = live.ports
    with FoxgloveClient(ws_port) as client:
        assert "clientPublish" in client.server["capabilities"]
        assert "json" in client.server["supportedEncodings"]
        client.publish("/elsewhere", THERE)
        client.publish(f"/{GAZE_TARGET}", THERE)
        graph.spin_until(lambda: targets, "the viewer's target")
    assert (tuple(targets[0].name), list(targets[0].position)) == (TARGET_NAMES, [5.0, -2.0])

    address = f"http://127.0.0.1:{page_port}"

    def has_picture() -> bool:
        pictures.publish(image_bytes(PICTURE, 7))
        try:
            with urllib.request.urlopen(f"{address}/left.png", timeout=PATIENCE_S):
                return True
        except HTTPError:
            return False

    graph.spin_until(has_picture, "the page's picture")
    _click(address, "column_px=160&row_px=20")
    graph.spin_until(lambda: len(targets) > 1, "the click's target")
    np.testing.assert_allclose(targets[1].position, [0.0, 45.0], atol=1e-12)
