"""Gratings before one eye, and what the code explains of them."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from active_binocular_vision.examinations.clinic.gratings import (
    CYCLES_PER_PX,
    Resolution,
    crossing,
    explained_share,
    finest,
    grating,
    resolution,
    rival_shares,
)
from eye_plant.camera.config import CameraConfig
from lockstep.scales import ScalesConfig
from sparse_coder import SparseCoder, SparseCoderConfig

_FEW = CYCLES_PER_PX[[4, 12]]


@pytest.fixture(scope="module")
def coder() -> SparseCoder:
    return SparseCoder(SparseCoderConfig())


def test_a_grating_has_its_frequency_orientation_and_phase() -> None:
    # A quarter of a cycle a pixel: 128 + 127 sin of 45, 135, 225, 315 and 405 deg.
    vertical = grating((8, 6), 0.25, 90.0, 45.0)
    assert vertical.shape == (6, 8)
    assert vertical[:, :5].tolist() == [[218, 218, 38, 38, 218]] * 6
    horizontal = grating((8, 6), 0.25, 0.0, 45.0)
    np.testing.assert_array_equal(horizontal[:, 0], vertical[0, :6])
    assert (horizontal == horizontal[:, :1]).all()


def test_acuity_is_where_the_share_last_falls_through_a_half() -> None:
    frequencies = np.array([1.0, 4.0, 16.0])
    # Half-way between 0.75 and 0.25 on a logarithmic axis between 4 and 16.
    assert Resolution(frequencies, np.array([[0.2], [0.75], [0.25]])).acuity == pytest.approx(8.0)
    assert Resolution(frequencies, np.array([[0.9], [0.9], [0.5]])).acuity == pytest.approx(16.0)
    assert Resolution(frequencies, np.array([[0.4], [0.3], [0.2]])).acuity is None


def test_log_mar_is_that_of_half_a_cycle() -> None:
    # Half a cycle of 3 cycles/deg is 10 minutes wide.
    three = Resolution(np.array([1.0, 3.0]), np.array([[0.9], [0.5]]))
    assert three.log_mar == pytest.approx(1.0)
    assert Resolution(np.array([1.0]), np.array([[0.4]])).log_mar is None


def test_the_interval_of_an_acuity_is_that_over_gratings() -> None:
    frequencies = np.array([1.0, 4.0, 16.0])
    alike = np.repeat([[0.9], [0.75], [0.25]], 8, axis=1)
    assert Resolution(frequencies, alike).interval == pytest.approx((8.0, 8.0))
    # Half of the gratings are seen up to 16 cycles/deg, half of them are not seen at all.
    apart = np.repeat([[1.0, 0.0]] * 3, 4, axis=0).reshape(3, 8)
    assert Resolution(frequencies, apart).interval == pytest.approx((0.0, 16.0))
    assert Resolution(frequencies, alike[:, :1]).interval is None


def test_a_crossing_is_linear_over_the_logarithm() -> None:
    log_x = np.log([1.0, 10.0])
    assert crossing(log_x, np.array([1.0, 0.0]), 0.7) == pytest.approx(10.0**0.3)


def test_the_share_is_that_of_the_fine_code(coder: SparseCoder) -> None:
    picture = grating((128, 128), 0.2, 45.0, 45.0)
    black = np.zeros_like(picture)
    error = coder.encode(black, picture).reconstruction_error[1]
    share = explained_share(coder, (black, picture), (black, picture))
    assert share == pytest.approx(1.0 - error, abs=1e-5)
    assert 0.05 < error < 0.95


def test_a_foveal_scale_sees_finer_gratings_and_gains_of_eyes_do_not_count() -> None:
    scales = ScalesConfig(("fine", "foveal"), (40, 40), (40, 40), (1.0, 4.0), (0.0, 0.0))
    coder = SparseCoder(SparseCoderConfig(scales=scales, suppression_iterations=10))
    assert finest(coder).name == "foveal"
    camera = CameraConfig(width_px=128, height_px=128, roi_width_px=128, roi_height_px=128)
    found = resolution(coder, camera, 1, _FEW)
    left, right = rival_shares(coder, camera)
    assert left == pytest.approx(right, abs=0.05)
    np.testing.assert_allclose(found.cycles_per_deg, 4.0 * _FEW / 0.2226, rtol=1e-2)
    coder.dominances = [np.full_like(of_scale, 0.9) for of_scale in coder.dominances]
    suppressed = resolution(coder, camera, 1, _FEW)
    left, right = rival_shares(coder, camera)
    assert left > 0.3
    assert right < 0.1
    np.testing.assert_allclose(suppressed.explained, found.explained, atol=1e-3)
    # A pixel's blur, which leaves 14 % of the finer grating's contrast, is one of four here.
    blurred = replace(camera, right_blur_px=1.0)
    assert resolution(coder, blurred, 1, _FEW).explained[1] < 0.05 < found.explained[1]


def test_what_is_not_seen_or_is_something_else_explains_nothing(coder: SparseCoder) -> None:
    shown = grating((128, 128), 0.2, 90.0, 45.0)
    black = np.zeros_like(shown)
    assert explained_share(coder, (shown, black), (black, black)) == 0.0
    across = grating((128, 128), 0.2, 0.0, 45.0)
    assert explained_share(coder, (shown, black), (across, black)) == 0.0


def test_each_eye_has_its_own_blur_cover_and_magnification(coder: SparseCoder) -> None:
    size: dict[str, Any] = {
        "width_px": 128,
        "height_px": 128,
        "roi_width_px": 128,
        "roi_height_px": 128,
    }
    sharp = resolution(coder, CameraConfig(**size), 0, _FEW)
    np.testing.assert_allclose(sharp.cycles_per_deg, _FEW / 0.2226, rtol=1e-3)

    blurred = CameraConfig(**size, right_blur_px=60.0)
    # Nearly nothing: rounding leaves some patches with a step of one grey level.
    assert (resolution(coder, blurred, 1, _FEW).explained < 0.05).all()
    assert (sharp.explained > 0.1).all()
    np.testing.assert_array_equal(resolution(coder, blurred, 0, _FEW).explained, sharp.explained)

    covered = resolution(coder, CameraConfig(**size, left_occluded=True), 0, _FEW)
    assert covered.acuity is None
    larger = resolution(coder, CameraConfig(**size, left_magnification=2.0), 0, _FEW)
    np.testing.assert_allclose(larger.cycles_per_deg, 2.0 * sharp.cycles_per_deg, rtol=1e-4)
