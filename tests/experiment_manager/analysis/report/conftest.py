from pathlib import Path

import pytest

from experiment_manager.analysis.report.reported_run import ReportedRun


@pytest.fixture(scope="package")
def runs(run_directories: dict[str, Path]) -> list[ReportedRun]:
    return [ReportedRun(directory) for directory in run_directories.values()]
