"""What the tests of bags write."""

import numpy as np
import pytest

from tests.experiment_manager.bag.bag_harness import N_MESSAGES, NAMES, PERIOD_NS


@pytest.fixture
def messages(vector_bytes, image_bytes) -> list[tuple[str, bytes, int]]:
    """Thirty vectors, a picture with every tenth of them."""
    rng = np.random.default_rng(5)
    found = []
    for i in range(N_MESSAGES):
        stamp_ns = i * PERIOD_NS
        vector = vector_bytes(NAMES, [i, i + 0.5], stamp_ns)
        found.append(("ground_truth", vector, stamp_ns))
        if i % 10 == 0:
            picture = rng.integers(0, 256, (12, 16), dtype=np.uint8)
            found.append(("left/image_raw", image_bytes(picture, stamp_ns), stamp_ns))
    return found
