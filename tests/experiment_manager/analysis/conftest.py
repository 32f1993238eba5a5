from collections.abc import Iterator
from pathlib import Path

import matplotlib as mpl
import pytest

from experiment_manager.analysis.reported_run import ReportedRun
from lockstep.figures import STYLE


@pytest.fixture(autouse=True)
def style() -> Iterator[None]:
    """Figures are drawn as the commands draw them."""
    with mpl.rc_context(STYLE):
        yield


@pytest.fixture(scope="package")
def runs(run_directories: dict[str, Path]) -> list[ReportedRun]:
    return [ReportedRun(directory) for directory in run_directories.values()]
