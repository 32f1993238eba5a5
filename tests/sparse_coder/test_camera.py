import numpy as np
import pytest
from sensor_msgs.msg import CameraInfo, Image, RegionOfInterest

from lockstep import InputError
from lockstep.optics import Pinhole
from sparse_coder.camera import central_view
from sparse_coder.messages import camera_of, picture_of

FOCAL_PX = 257.34


def _noise(*shape: int) -> np.ndarray:
    return np.random.default_rng(0).integers(0, 256, shape, dtype=np.uint8)


def test_the_view_of_the_cameras_own_focal_length_is_the_pictures_centre() -> None:
    picture = _noise(240, 320)
    view = central_view(picture, Pinhole.ideal(FOCAL_PX, 240, 320), FOCAL_PX)
    assert (view == picture[56:184, 96:224]).all()


@pytest.mark.parametrize("factor", [0.75, 1.0, 2.0, 3.1])
def test_a_direction_keeps_its_place_whatever_the_focal_length(factor: float) -> None:
    # A ramp across: the grey value says from which column, and so from which direction it came.
    focal_px, centre_px = factor * 100.0, (333.0, 210.0)
    ramp = np.tile(np.clip(np.arange(640) / 2.5, 0, 255).round(), (480, 1)).astype(np.uint8)
    view = central_view(ramp, Pinhole((focal_px, focal_px), centre_px), 100.0)
    tangents = (np.arange(128) - 63.5) / 100.0
    expected = (centre_px[0] + focal_px * tangents) / 2.5
    np.testing.assert_allclose(view[64], expected, atol=1.0)


def test_a_picture_that_shrinks_is_averaged() -> None:
    view = central_view(_noise(640, 640), Pinhole.ideal(4 * FOCAL_PX, 640, 640), FOCAL_PX)
    # White noise of SD 74: of 16 independent pixels each it would be 18.
    assert 10.0 < view.std() < 25.0


def test_distortion_is_taken_out() -> None:
    camera = Pinhole((300.0, 300.0), (159.5, 159.5), (0.2, 0.0, 0.0, 0.0, 0.0))
    columns = np.tile(np.arange(320.0) * 0.75, (320, 1)).astype(np.uint8)
    view = central_view(columns, camera, 300.0)
    x = (100 - 63.5) / 300.0
    y = (20 - 63.5) / 300.0
    seen_at = 159.5 + 300.0 * x * (1.0 + 0.2 * (x**2 + y**2))  # Brown's radial term
    assert view[20, 100] == pytest.approx(0.75 * seen_at, abs=1.0)


def test_a_camera_that_sees_too_little_is_refused() -> None:
    with pytest.raises(InputError, match=r"field of view of 27.9 deg .* got 160 x 120 px"):
        central_view(_noise(120, 160), Pinhole.ideal(FOCAL_PX, 120, 160), FOCAL_PX)


@pytest.mark.parametrize("distortion", [(0.1,), (0.1, 0.2, 0.3, float("nan"))])
def test_a_lens_without_its_numbers_is_refused(distortion: tuple[float, ...]) -> None:
    with pytest.raises(InputError, match="expected positive focal lengths, and the coefficients"):
        central_view(_noise(240, 320), Pinhole((300.0,) * 2, (160.0, 120.0), distortion), FOCAL_PX)


@pytest.mark.parametrize(
    ("encoding", "pixel", "grey"),
    [
        ("mono8", [7], 7),
        ("bgr8", [255, 0, 0], 29),
        ("rgb8", [255, 0, 0], 76),
        ("bgra8", [255, 0, 0, 9], 29),
        ("rgba8", [255, 0, 0, 9], 76),
    ],
)
def test_pictures_of_all_encodings(encoding: str, pixel: list[int], grey: int) -> None:
    row = bytes(pixel) * 3 + bytes(2)  # padded
    message = Image(height=2, width=3, encoding=encoding, step=len(row), data=row * 2)
    assert picture_of(message, "t").tolist() == [[grey] * 3] * 2


@pytest.mark.parametrize("size", [{}, {"height": 2, "step": 3, "data": bytes(6)}])
@pytest.mark.parametrize("encoding", ["mono8", "bgr8"])
def test_a_picture_without_pixels_is_refused(encoding: str, size) -> None:
    with pytest.raises(InputError, match="t: expected an image of mono8"):
        picture_of(Image(encoding=encoding, **size), "t")


def test_a_calibration_with_region_and_binning() -> None:
    k = [800.0, 0.0, 320.0, 0.0, 810.0, 240.0, 0.0, 0.0, 1.0]
    roi = RegionOfInterest(x_offset=100, y_offset=40, width=440, height=400)
    info = CameraInfo(k=k, d=[0.0] * 5, distortion_model="plumb_bob", roi=roi)
    info.binning_x = info.binning_y = 2
    # Pixels 220 and 221 of the region are pixel 110, whose centre is theirs: 220.5.
    assert camera_of(info, "t") == Pinhole((400.0, 405.0), (109.75, 99.75))


@pytest.mark.parametrize("changes", [{"k": [0.0] * 9}, {"distortion_model": "equidistant"}])
def test_what_is_no_calibration_is_refused(changes) -> None:
    good = {"k": [800.0, 0.0, 320.0, 0.0, 810.0, 240.0, 0.0, 0.0, 1.0]}
    with pytest.raises(InputError, match="left/camera_info: expected a calibrated camera"):
        camera_of(CameraInfo(**(good | changes)), "left/camera_info")
