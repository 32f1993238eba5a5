"""The examples in the docstrings of classes and functions that people use."""

import doctest
import importlib
from collections.abc import Callable
from pathlib import Path

import pytest

MODULES = (
    "active_binocular_vision.environments.active_vergence",
    "active_binocular_vision.environments.vector",
    "active_binocular_vision.learners.learners",
    "active_binocular_vision.runs.run",
    "active_binocular_vision.study",
    "experiment_manager.bag.reader",
    "experiment_manager.loop",
    "eye_plant.plant",
    "sparse_coder.coder",
    "vergence_rl.agent",
)


@pytest.fixture
def study(
    tmp_path: Path,
    pictures: Path,
    run_of: Callable[[str], Path],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Work where there are images and a run."""
    (tmp_path / "runs").mkdir()
    (tmp_path / "runs" / "first").symlink_to(run_of("pair"))
    (tmp_path / "photos").symlink_to(pictures)
    monkeypatch.chdir(tmp_path)


@pytest.mark.usefixtures("study")
@pytest.mark.parametrize("module", MODULES)
def test_examples_give_what_they_say(module: str) -> None:
    result = doctest.testmod(importlib.import_module(module))
    assert result.attempted
    assert not result.failed
