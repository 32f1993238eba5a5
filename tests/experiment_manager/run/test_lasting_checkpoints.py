"""Which checkpoints stay when others are deleted."""

from pathlib import Path

from experiment_manager.run import checkpoint
from experiment_manager.run.checkpoint import Manifest


def _commit(directory: Path, place: int, lasting: tuple[int, ...]) -> None:
    checkpoint.place_directory(directory, place).mkdir(parents=True)
    checkpoint.commit(directory, Manifest(place, {}, (), {}, {}), lasting)


def test_the_last_two_and_those_that_are_to_stay(tmp_path: Path) -> None:
    for place in (0, 10, 20, 30, 40, 50):
        _commit(tmp_path, place, lasting=(10, 30))
    assert [int(path.name) for path in sorted(tmp_path.iterdir())] == [10, 30, 40, 50]
