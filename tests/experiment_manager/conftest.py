"""Serialized messages of the graph's topics, and bags of them, for the tests of this package."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbags.typesys import Stores, get_typestore

from experiment_manager.bag_writer import BagWriter

VECTOR = "sensor_msgs/msg/JointState"
IMAGE = "sensor_msgs/msg/Image"
PERIOD_NS = 100_000_000

VectorBytes = Callable[..., bytes]
ImageBytes = Callable[[np.ndarray, int], bytes]


# Not rclpy's serialize_message: that one returns a few bytes too many, which no wire carries.
_STORE = get_typestore(Stores.ROS2_JAZZY)
_HEADER = _STORE.types["std_msgs/msg/Header"]
_TIME = _STORE.types["builtin_interfaces/msg/Time"]


def _header(stamp_ns: int, frame: str) -> Any:
    return _HEADER(_TIME(*divmod(stamp_ns, 1_000_000_000)), frame)


def _vector_bytes(
    names: Sequence[str],
    position: Sequence[float],
    stamp_ns: int = 0,
    velocity: Sequence[float] = (),
    effort: Sequence[float] = (),
) -> bytes:
    numbers = [np.array(values, dtype=np.float64) for values in (position, velocity, effort)]
    message = _STORE.types[VECTOR](_header(stamp_ns, ""), list(names), *numbers)
    return bytes(_STORE.serialize_cdr(message, VECTOR))


def _image_bytes(picture: np.ndarray, stamp_ns: int) -> bytes:
    height, width = picture.shape
    encoding = {"uint8": "mono8", "float32": "32FC1"}[picture.dtype.name]
    data = np.frombuffer(picture.tobytes(), np.uint8)
    message = _STORE.types[IMAGE](
        _header(stamp_ns, "left_eye"), height, width, encoding, 0, width * picture.itemsize, data
    )
    return bytes(_STORE.serialize_cdr(message, IMAGE))


@pytest.fixture
def vector_bytes() -> VectorBytes:
    """Return a function that serializes a JointState."""
    return _vector_bytes


@pytest.fixture
def image_bytes() -> ImageBytes:
    """Return a function that serializes an Image."""
    return _image_bytes


@pytest.fixture
def make_bag(tmp_path: Path) -> Callable[..., Path]:
    """Return a function that writes vectors {topic: (names, values (n, k))} into a new bag."""

    def write(
        tables: Mapping[str, tuple[Sequence[str], np.ndarray]], name: str = "bag", n_files: int = 1
    ) -> Path:
        directory = tmp_path / name
        topics = dict.fromkeys(tables, VECTOR)
        with BagWriter(directory, topics, {"model": "M", "seed": "1"}) as writer:
            n_rows = max(len(values) for _, values in tables.values())
            for row in range(n_rows):
                for topic, (names, values) in tables.items():
                    if row < len(values):
                        stamp_ns = row * PERIOD_NS
                        writer.write(topic, _vector_bytes(names, values[row], stamp_ns), stamp_ns)
                if (row + 1) % -(-n_rows // n_files) == 0:
                    writer.commit()
        return directory

    return write
