"""The tests of which a run keeps the trials."""

from pathlib import Path

from experiment_manager import Trials
from experiment_manager.measures.kept_trials import read_kept


def kept_tests(directory: Path) -> list[Trials]:
    """Return the tests in a run directory's trials.npz, none when there is no such file."""
    kept = read_kept(directory)
    return kept.tests() if kept else []
