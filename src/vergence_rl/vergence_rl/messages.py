"""Features from sensor_msgs/Image."""

import numpy as np
from sensor_msgs.msg import Image

from lockstep.errors import InputError

_SCALES = 2


def features_of(message: Image) -> np.ndarray:
    """Return the features (2, n_bases) float32 of a 32FC1 message, without a copy.

    Raises InputError for another encoding, another number of rows, data that does not match the
    stated size, and values that are not finite.
    """
    height, width = message.height, message.width
    if (
        message.encoding != "32FC1"
        or message.is_bigendian
        or height != _SCALES
        or len(message.data) != 4 * width * height
    ):
        raise InputError(
            f"features: expected little-endian 32FC1 with {_SCALES} rows and 4 bytes an entry, "
            f"got {message.encoding!r}, {height} x {width}, {len(message.data)} bytes"
        )
    features = np.frombuffer(message.data, dtype=np.float32).reshape(height, width)
    if not np.isfinite(features).all():
        raise InputError("features: expected finite values, got NaN or infinity")
    return features
