"""What all tests share: a ROS that stays on this machine, and a few small pictures."""

import os
from pathlib import Path

import cv2
import numpy as np
import pytest

os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

STIMULUS_PX = 64


@pytest.fixture(scope="session")
def pictures(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a directory of small stimuli: 3 for training, 2 for tests."""
    directory = tmp_path_factory.mktemp("pictures")
    draw = np.random.default_rng(1)
    for part, n_pictures in (("train", 3), ("test", 2)):
        (directory / part).mkdir()
        for i in range(n_pictures):
            coarse = draw.integers(0, 256, (8, 8), dtype=np.uint8)
            picture = cv2.resize(coarse, (STIMULUS_PX, STIMULUS_PX), interpolation=cv2.INTER_LINEAR)
            cv2.imwrite(str(directory / part / f"{i}.png"), picture)
    return directory
