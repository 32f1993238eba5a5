"""From a calibrated camera's picture to the one that the coder takes, of the focal length it knows.

The coder's windows are so many pixels wide, and a pixel is an angle: a robot's camera has another
focal length, another size, perhaps colours and a lens that distorts.
"""

import functools
import math

import cv2
import numpy as np
from numpy.typing import NDArray

from lockstep import InputError
from lockstep.optics import Pinhole
from sparse_coder.patches import COARSE, Image

# Of OpenCV's model of a lens: what plumb_bob and rational_polynomial have.
_N_COEFFICIENTS = (0, 4, 5, 8, 12, 14)
# From the centre of the window to the centre of its outermost pixel.
_HALF_PX = (COARSE.window_px - 1) / 2.0
# Samples of a picture that shrinks are averages over as much of it: a Gaussian, whose SD in its own
# pixels is that share of the factor (Burt & Adelson's pyramid: about 1 for a factor of 2).
_BLUR_SHARE = 0.5


def central_view(picture: Image, camera: Pinhole, focal_px: float) -> Image:
    """Return what the coarse window shows, 128 x 128 px about the principal point.

    picture: grey uint8 (height, width), as the camera took it; focal_px: of the view that is
    returned, without distortion. Raises InputError where the picture does not show all of it.
    """
    height_px, width_px = picture.shape
    factor = camera.focal_px[0] / focal_px
    across, down = _maps(camera, focal_px)
    ends = across.min(), down.min(), width_px - 1 - across.max(), height_px - 1 - down.max()
    if min(ends) < -0.5:
        least_deg = 2.0 * math.degrees(math.atan(COARSE.window_px / 2.0 / focal_px))
        raise InputError(
            f"image: expected a field of view of {least_deg:.1f} deg or more about the principal "
            f"point, got {width_px} x {height_px} px with a focal length of "
            f"{camera.focal_px[0]:g} px; a camera that sees less needs a larger "
            "eyes.camera.focal_length_px"
        )
    if factor > 1.0:
        sd_px = _BLUR_SHARE * math.sqrt(factor**2 - 1.0)
        picture = np.asarray(cv2.GaussianBlur(picture, (0, 0), sd_px), np.uint8)
    view = cv2.remap(picture, across, down, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return np.asarray(view, np.uint8)


@functools.lru_cache(maxsize=8)
def _maps(camera: Pinhole, focal_px: float) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return for each pixel of the view its place in the picture, across and down, (128, 128)."""
    is_finite = np.isfinite((*camera.focal_px, *camera.centre_px, *camera.distortion)).all()
    has_lens = len(camera.distortion) in _N_COEFFICIENTS and min(camera.focal_px) > 0.0
    if not (is_finite and has_lens):
        raise InputError(
            "camera_info: expected positive focal lengths, and the coefficients of plumb_bob or "
            f"rational_polynomial, all finite, got {camera}"
        )
    taken = np.diag((*camera.focal_px, 1.0))
    taken[:2, 2] = camera.centre_px
    wanted = np.diag((focal_px, focal_px, 1.0))
    wanted[:2, 2] = _HALF_PX
    size = COARSE.window_px, COARSE.window_px
    across, down = cv2.initUndistortRectifyMap(
        taken, np.array(camera.distortion), np.eye(3), wanted, size, cv2.CV_32FC1
    )
    return np.asarray(across, np.float32), np.asarray(down, np.float32)
