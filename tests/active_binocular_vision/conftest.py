import copy
from collections.abc import Iterator
from pathlib import Path

import matplotlib as mpl
import pytest

from active_binocular_vision.figures.style import STYLE
from active_binocular_vision.runs.finished_run import FinishedRun


@pytest.fixture(autouse=True)
def style() -> Iterator[None]:
    """Figures are drawn as the commands draw them."""
    with mpl.rc_context(STYLE):
        yield


@pytest.fixture(scope="package")
def read_runs(run_directories: dict[str, Path]) -> list[FinishedRun]:
    return [FinishedRun(directory) for directory in run_directories.values()]


@pytest.fixture
def runs(read_runs: list[FinishedRun]) -> list[FinishedRun]:
    """Runs of M and of M_C, to change at will; what their bags hold is read once for all tests."""
    return [copy.copy(run) for run in read_runs]
