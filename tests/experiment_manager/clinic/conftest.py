"""Small runs of all kinds of eyes, hardly trained, and rooms with their learners."""

import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, redirect_stdout
from pathlib import Path

import pytest

from experiment_manager.clinic.room import Room, examination_room
from experiment_manager.commands.run_experiment import main as run_experiment
from experiment_manager.frozen.learners import FrozenLearners
from experiment_manager.frozen.shown import Shown
from tests.made_once import made_once

_SETTINGS = {
    "eye_plant.camera.renderer": "plane",
    "eye_plant.stimuli.size_px": 64,
    "experiment_manager.protocol.test_distances_m": "[2.0]",
    "experiment_manager.protocol.iterations_per_trial": 10,
}
PROFILES = {"pair": "precise", "twelve": "twelve", "gaze": "gaze"}

RunOf = Callable[[str], Path]
RoomOf = Callable[..., Room]


@pytest.fixture(scope="session")
def run_of(tmp_path_factory: pytest.TempPathFactory, pictures: Path) -> RunOf:
    """Return a function that returns the run directory of a kind of eyes."""

    def run(kind: str) -> Path:
        def make(directory: Path) -> None:
            line = ["--in-process", "--profile", PROFILES[kind], "--iterations", "40"]
            line += ["--tests", "40", "--stimuli", str(pictures), "--out", str(directory / "run")]
            line += ["--test-stimuli", "1"]
            settings = _SETTINGS | (
                {"experiment_manager.protocol.n_starts_per_distance": 1} if kind != "pair" else {}
            )
            for name, value in settings.items():
                line += ["--set", f"{name}={value}"]
            # What a test reads of standard output is its own.
            with redirect_stdout(sys.stderr):
                assert run_experiment(line) == 0

        return made_once(tmp_path_factory, f"clinic_{kind}", make) / "run"

    return run


@pytest.fixture
def room_of(run_of: RunOf) -> Iterator[RoomOf]:
    """Return a function that returns a room with a kind of eyes, and one picture."""
    with ExitStack() as rooms:

        def room(kind: str, shown: Shown | None = None, **settings: object) -> Room:
            learners = FrozenLearners(run_of(kind), settings=settings)
            shown = Shown(n_most=1) if shown is None else shown
            return rooms.enter_context(examination_room(learners, shown, 1))

        yield room
