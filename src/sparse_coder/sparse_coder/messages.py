"""Pictures from, and features into, sensor_msgs/Image."""

import numpy as np
from sensor_msgs.msg import Image

from lockstep import InputError
from sparse_coder.patches import N_PIXELS


def picture_of(message: Image, topic: str) -> np.ndarray:
    """Return the grey picture (height, width) uint8 that a mono8 message holds, without a copy.

    Raises InputError for another encoding and for data that does not match the stated size.
    """
    height, width, step = message.height, message.width, message.step
    if message.encoding != "mono8" or step < width or len(message.data) != step * height:
        raise InputError(
            f"{topic}: expected a mono8 image of height x step bytes with step >= width, got "
            f"{message.encoding!r}, {height} x {step} (width {width}), {len(message.data)} bytes"
        )
    return np.frombuffer(message.data, dtype=np.uint8).reshape(height, step)[:, :width]


def features_message(n_bases: int) -> Image:
    """Return the message of features (2, n_bases) float32, without stamp and data.

    A picture of 32-bit floats, one row per scale: it opens in any viewer.
    """
    return Image(height=2, width=n_bases, encoding="32FC1", step=4 * n_bases)


def basis_functions_message(n_bases: int) -> Image:
    """Return the message of atoms (2, n_bases, n_pixels) float32, without stamp and data.

    A picture of 32-bit floats, one row per atom, coarse above fine.
    """
    return Image(height=2 * n_bases, width=N_PIXELS, encoding="32FC1", step=4 * N_PIXELS)
