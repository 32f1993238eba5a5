"""What all tests share: a ROS that stays on this machine, OpenGL, and a few small pictures."""

import ctypes.util
import gc
import importlib
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import threadpoolctl

from lockstep.machine.environment import adopt
from tests.made_once import made_once

gc.disable()  # until all is imported, which is most of what there ever is
adopt()
# NumPy has read that variable before.
threadpoolctl.threadpool_limits(1)
# MuJoCo, when it is imported, loads the OpenGL that this variable names. The tests themselves
# compare pictures with those of its renderer; what they start needs none.
os.environ["MUJOCO_GL"] = "egl" if ctypes.util.find_library("EGL") else "disable"
importlib.import_module("mujoco")
os.environ["MUJOCO_GL"] = "disable"

STIMULUS_PX = 64
pytest_plugins = ["tests.made_runs"]


# By seconds on two idle cores, longest first; each module stays in one worker.
LONGEST = (
    *("graph", "command_spaces", "sweep", "slurm", "faults", "hosts", "node_by_node", "resources"),
    *("packaging", "examples", "tutorials", "live_view", "docs", "set_up"),
)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with the longest tests: those of whole runs, so that no core ends with one of them."""
    ranks = {f"test_{name}": rank for rank, name in enumerate(LONGEST, start=-len(LONGEST))}
    of_rules = {"test_contract": 1, "test_rules": 1}  # of many short tests

    def rank(item: pytest.Item) -> int:
        if "integration" in item.path.parts:
            return ranks.get(item.path.stem, 0)
        return of_rules.get(item.path.stem, 2)

    items.sort(key=rank)


def pytest_collection_finish() -> None:
    """Look for garbage from now on, and not among what stays, as the commands do."""
    gc.freeze()
    gc.enable()


@pytest.fixture
def graph() -> Iterator[Any]:
    """Yield a ROS domain of the test's own, a tests.node_harness.Graph."""
    from tests.node_harness import ros_graph

    with ros_graph() as graph:
        yield graph


@pytest.fixture(scope="session")
def pictures(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a directory of small stimuli: 3 for training, 2 for tests."""
    return made_once(tmp_path_factory, "pictures", _draw_pictures)


def _draw_pictures(directory: Path) -> None:
    draw = np.random.default_rng(1)
    for part, n_pictures in (("train", 3), ("test", 2)):
        (directory / part).mkdir()
        for i in range(n_pictures):
            coarse = draw.integers(0, 256, (8, 8), dtype=np.uint8)
            picture = cv2.resize(coarse, (STIMULUS_PX, STIMULUS_PX), interpolation=cv2.INTER_LINEAR)
            cv2.imwrite(str(directory / part / f"{i}.png"), picture)
