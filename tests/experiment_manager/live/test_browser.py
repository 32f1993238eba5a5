"""The live view's page in a browser without a window, as somebody sees it."""

import shutil
from collections.abc import Iterator
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


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    """Return a Chromium without a window; skip where there is none."""
    playwright = pytest.importorskip("playwright.sync_api")
    with playwright.sync_playwright() as started:
        try:
            browser = started.chromium.launch(
                executable_path=shutil.which("chromium"), args=["--no-sandbox"]
            )
        except playwright.Error as error:
            pytest.skip(f"no Chromium starts here: {error}")
        yield browser
        browser.close()


@pytest.fixture
def steering() -> Iterator[tuple[Steering, str]]:
    """Return what a page of a run takes clicks with, and the page's address."""
    steering = Steering(Shown(F_PX, RUN))
    page = Page("127.0.0.1", 0, "", steering)
    yield steering, f"http://127.0.0.1:{page.port}"
    page.close()


def test_the_page_shows_the_run_its_error_both_eyes_and_the_click(browser, steering) -> None:
    steers, address = steering
    steers.shown.show([LEFT, RIGHT])
    for iteration, error_deg in ((100.0, 2.0), (12_000.0, 0.25)):
        steers.shown.learn(iteration, error_deg)
    page = browser.new_page()
    page.goto(address)
    page.wait_for_function("document.getElementById('status').textContent.startsWith('after')")
    assert page.inner_text("#run") == f"of {RUN}"
    # 1 px is 0.2226 deg.
    assert page.inner_text("#status") == (
        "after 12,000 training iterations: running vergence error 0.250 deg (1.1 px)"
    )
    for name in ("left", "right", "anaglyph"):
        page.wait_for_function(f"document.getElementById('{name}').naturalWidth == 320")
    drawn = "document.getElementById('curve').getContext('2d').getImageData(0, 0, 400, 200).data"
    assert page.evaluate(f"{drawn}.some((value) => value > 0)")
    assert page.locator("#mark").is_hidden()
    page.click("#left", position={"x": 30, "y": 20})
    page.wait_for_function("!document.getElementById('mark').hidden")
    mark = page.locator("#mark").bounding_box()
    left = page.locator("#left").bounding_box()
    centre = [mark[a] + mark[b] / 2.0 - left[a] for a, b in (("x", "width"), ("y", "height"))]
    assert centre == pytest.approx([30.0, 20.0], abs=1.5)
    sideways_deg, up_deg = dict(zip(TARGET_NAMES, steers.take(), strict=True)).values()
    assert sideways_deg < 0.0 < up_deg, "left of the centre, and above it"
    page.close()


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
