"""Pictures from, and features into, sensor_msgs/Image."""

import cv2
import numpy as np
from sensor_msgs.msg import CameraInfo, Image

from lockstep import InputError
from lockstep.optics import Pinhole
from sparse_coder.patches import N_PIXELS

# OpenCV's conversions to grey by encoding, and bytes of a pixel.
_TO_GREY = {
    "mono8": (None, 1),
    "bgr8": (cv2.COLOR_BGR2GRAY, 3),
    "rgb8": (cv2.COLOR_RGB2GRAY, 3),
    "bgra8": (cv2.COLOR_BGRA2GRAY, 4),
    "rgba8": (cv2.COLOR_RGBA2GRAY, 4),
}


def picture_of(message: Image, topic: str) -> np.ndarray:
    """Return the picture (height, width) uint8 of a message as grey; mono8 without a copy.

    Raises InputError for an encoding that is neither mono8 nor 8 bits of colours, for a picture
    without pixels, and for data that does not match the stated size.
    """
    height, width, step = message.height, message.width, message.step
    conversion, n_bytes = _TO_GREY.get(message.encoding, (None, 0))
    n_used = width * n_bytes  # of a row
    if not n_used * height or step < n_used or len(message.data) != step * height:
        raise InputError(
            f"{topic}: expected an image of {', '.join(_TO_GREY)} with height x step bytes and "
            f"step >= width x bytes of a pixel, got {message.encoding!r}, {height} x {step} "
            f"(width {width}), {len(message.data)} bytes"
        )
    rows = np.frombuffer(message.data, dtype=np.uint8).reshape(height, step)[:, :n_used]
    if conversion is None:
        return rows
    return np.asarray(cv2.cvtColor(rows.reshape(height, width, n_bytes), conversion), np.uint8)


def camera_of(message: CameraInfo, topic: str) -> Pinhole:
    """Return the camera that a message describes.

    A region of interest and binning are taken account of. Raises InputError for a lens that is
    neither plumb_bob nor rational_polynomial, and for numbers that are no calibration.
    """
    model, k = message.distortion_model, [float(value) for value in message.k]
    if model not in ("", "plumb_bob", "rational_polynomial") or not (
        np.isfinite(k).all() and k[0] > 0.0 and k[4] > 0.0
    ):
        raise InputError(
            f"{topic}: expected a calibrated camera of plumb_bob or rational_polynomial, with the "
            f"focal lengths in k, got {model!r} with k {k}"
        )
    binned = max(message.binning_x, 1), max(message.binning_y, 1)
    # A pixel's centre is at a whole number, its edges half a pixel away.
    offsets = message.roi.x_offset, message.roi.y_offset
    centre = (
        (c - at + 0.5) / n - 0.5 for c, at, n in zip((k[2], k[5]), offsets, binned, strict=True)
    )
    distortion = tuple(float(value) for value in message.d)
    return Pinhole(
        (k[0] / binned[0], k[4] / binned[1]),
        (next(centre), next(centre)),
        distortion if any(distortion) else (),
    )


def features_message(n_scales: int, n_bases: int) -> Image:
    """Return the message of features (n_scales, n_bases) float32, without stamp and data.

    A picture of 32-bit floats, one row per scale: it opens in any viewer.
    """
    return Image(height=n_scales, width=n_bases, encoding="32FC1", step=4 * n_bases)


def basis_functions_message(n_scales: int, n_bases: int) -> Image:
    """Return the message of atoms (n_scales, n_bases, n_pixels) float32, without stamp and data.

    A picture of 32-bit floats, one row per atom, coarse above fine.
    """
    return Image(height=n_scales * n_bases, width=N_PIXELS, encoding="32FC1", step=4 * N_PIXELS)
