import pytest

from eye_plant.camera.config import CameraConfig
from eye_plant.messages import camera_info


def test_a_larger_picture_has_a_longer_focal_length() -> None:
    config = CameraConfig(right_magnification=1.25)
    left, right = (camera_info(config, i_eye, baseline_m=0.056) for i_eye in (0, 1))
    assert (left.k[0], left.k[4], left.p[0]) == pytest.approx([257.34] * 3)
    assert (right.k[0], right.k[4], right.p[0], right.p[5]) == pytest.approx([1.25 * 257.34] * 4)
