import copy
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from active_binocular_vision import FrozenLearners, Run
from active_binocular_vision.figures.style import own_style
from active_binocular_vision.learners.session import Session, session_of
from active_binocular_vision.learners.shown import OWN_TEST_STIMULI, Shown


@pytest.fixture(autouse=True)
def style() -> Iterator[None]:
    """Figures are drawn as the commands draw them."""
    with own_style():
        yield


@pytest.fixture(scope="package")
def read_runs(run_directories: dict[str, Path]) -> list[Run]:
    return [Run(directory) for directory in run_directories.values()]


@pytest.fixture
def runs(read_runs: list[Run]) -> list[Run]:
    """Runs of M and of M_C, to change at will; what their bags hold is read once for all tests."""
    return [copy.copy(run) for run in read_runs]


SessionWith = Callable[..., Session]


@pytest.fixture
def session_with(run_of: Callable[[str], Path]) -> Iterator[SessionWith]:
    """Return a function that returns a session with a kind of eyes, and one picture."""
    with ExitStack() as sessions:

        def session(kind: str, shown: Shown = OWN_TEST_STIMULI, **settings: object) -> Session:
            learners = FrozenLearners(run_of(kind), settings=settings)
            return sessions.enter_context(session_of(learners, shown, 1))

        yield session
