"""The live view's page in a browser without a window, as somebody sees it."""

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from experiment_manager.live.page import Page
from experiment_manager.live.shown import Shown
from experiment_manager.live.steering import Steering
from lockstep.wire.topics import TARGET_NAMES

F_PX = 257.34
LEFT = np.tile(np.linspace(0, 255, 320).astype(np.uint8), (240, 1))
RIGHT = np.full_like(LEFT, 40)
RUN = "gaze_short, profile gaze_m_c, model M_C, seed 1"
BROWSE = Path(__file__).with_name("browse.py")
NO_BROWSER = 5  # as browse.py has it
# The program gives up after half a minute where the page is wrong; a browser that hangs does not.
BROWSER_S = 200


@pytest.fixture
def steering() -> Iterator[tuple[Steering, str]]:
    """Return what a page of a run takes clicks with, and the page's address."""
    steering = Steering(Shown(F_PX, RUN))
    page = Page("127.0.0.1", 0, "", steering)
    yield steering, f"http://127.0.0.1:{page.port}"
    page.close()


def _browsed(address: str) -> dict[str, Any]:
    """Return what a browser shows of an address; skip where no browser answers."""
    pytest.importorskip("playwright.sync_api")
    with subprocess.Popen(
        [sys.executable, BROWSE, address],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,  # one group to kill: the program, its driver and the browser
    ) as process:
        try:
            said, complaint = process.communicate(timeout=BROWSER_S)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            pytest.skip(f"Chromium has not answered for {BROWSER_S} s")
    if process.returncode == NO_BROWSER:
        pytest.skip(complaint.splitlines()[0])
    assert process.returncode == 0, complaint
    return dict(json.loads(said))


def test_the_page_shows_the_run_its_error_both_eyes_and_the_click(steering) -> None:
    steers, address = steering
    steers.shown.show([LEFT, RIGHT])
    for iteration, error_deg in ((100.0, 2.0), (12_000.0, 0.25)):
        steers.shown.learn(iteration, error_deg)
    seen = _browsed(address)
    assert seen.pop("centre of mark") == pytest.approx([30.0, 20.0], abs=1.5)
    assert seen == {
        "run": f"of {RUN}",
        # 1 px is 0.2226 deg.
        "status": "after 12,000 training iterations: running vergence error 0.250 deg (1.1 px)",
        "curve is drawn": True,
        "mark is hidden": True,  # before the click
    }
    sideways_deg, up_deg = dict(zip(TARGET_NAMES, steers.take(), strict=True)).values()
    assert sideways_deg < 0.0 < up_deg, "left of the centre, and above it"


def test_an_anaglyph_has_the_left_eye_in_red() -> None:
    shown = Shown(F_PX)
    assert shown.png("anaglyph") == b""
    shown.show([LEFT, RIGHT])
    seen = cv2.imdecode(np.frombuffer(shown.png("anaglyph"), np.uint8), cv2.IMREAD_COLOR_RGB)
    assert seen is not None
    assert seen[0, -1].tolist() == [255, 40, 40]


def test_a_long_curve_keeps_its_ends_and_fewer_points() -> None:
    shown = Shown(F_PX)
    for i in range(5000):
        shown.learn(float(i), 1.0)
    iterations = [iteration for iteration, _ in shown.errors]
    assert iterations[0] == 0.0
    assert iterations[-1] > 4900.0
    assert 300 <= len(iterations) <= 600
    assert len(set(np.diff(iterations))) == 1, "evenly spread"
