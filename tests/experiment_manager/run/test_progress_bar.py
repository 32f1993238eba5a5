"""The bar says how much of the rest is tests."""

import io

import pytest

from experiment_manager import ExperimentManagerConfig, make_protocol
from experiment_manager.run import progress_bar
from experiment_manager.run.progress_bar import ProgressBar


def test_the_trials_left_are_in_the_bar(monkeypatch: pytest.MonkeyPatch) -> None:
    shown = io.StringIO()
    monkeypatch.setattr(progress_bar, "_terminal", lambda: shown)
    config = ExperimentManagerConfig(
        n_training_iterations=20, test_iterations=(0,), n_stimuli_per_test=1, n_test_stimuli=1
    )
    bar = ProgressBar(make_protocol(config), 0)
    for _ in range(40):
        bar.advance(0.5)
    bar.close()
    *_, last = shown.getvalue().splitlines()
    assert "training:" in last
    assert "39 test trials left" in last
    assert "|error| 0.50 deg" in last
