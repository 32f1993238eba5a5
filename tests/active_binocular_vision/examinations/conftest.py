"""Rooms with the learners of small runs, hardly trained."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from active_binocular_vision.examinations.room import Room, examination_room
from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.shown import OWN_TEST_STIMULI, Shown

RoomOf = Callable[..., Room]


@pytest.fixture
def room_of(run_of: Callable[[str], Path]) -> Iterator[RoomOf]:
    """Return a function that returns a room with a kind of eyes, and one picture."""
    with ExitStack() as rooms:

        def room(kind: str, shown: Shown = OWN_TEST_STIMULI, **settings: object) -> Room:
            learners = FrozenLearners(run_of(kind), settings=settings)
            return rooms.enter_context(examination_room(learners, shown, 1))

        yield room
