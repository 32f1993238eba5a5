"""Hostile input: what must be refused is, so that it says something when numbers stay the same."""

from collections.abc import Callable
from typing import Any

import numpy as np

from eye_plant.commands import target_activations
from lockstep.command_space import COMMAND_SPACES, MUSCLE_NAMES, PAIR
from lockstep.errors import InputError
from lockstep.wire.stamps import checked_stamp
from lockstep.wire.topics import EPISODE_NAMES, PICTURES
from lockstep.wire.vectors import values_of, whole_values_of
from sparse_coder.messages import picture_of
from tests.pair import HORIZONTAL_RECTI
from tests.stress.fuzzer import Hostility
from vergence_rl.messages import activations_of, features_of

PERIOD_NS = 200_000_000
N_MESSAGES = 6000


def _command(message: Any) -> None:
    values = values_of(message, message.name, "muscle_command")
    target_activations(message.name, values, np.zeros(len(MUSCLE_NAMES)))


def _picture(message: Any) -> None:
    if picture_of(message, "picture").shape != (240, 320):
        raise InputError("the coder looks at the size")


def _features(message: Any) -> None:
    if features_of(message).shape[1] != 32:
        raise InputError("the agent looks at the size")


DOORS: dict[str, tuple[Callable[[Any], Any], ...]] = {
    "episode": (lambda message: whole_values_of(message, EPISODE_NAMES, "episode"),),
    "muscle_activations": (
        lambda message: activations_of(message, COMMAND_SPACES[PAIR]),
        lambda message: values_of(message, HORIZONTAL_RECTI, "muscle_activations", "effort"),
    ),
    "reward": (lambda message: values_of(message, ("reward",), "reward"),),
    "muscle_command": (_command,),
    "features": (_features,),
    **dict.fromkeys(PICTURES, (_picture,)),
}


def _stamp_ns(message: Any) -> int:
    try:
        stamp = message.header.stamp
        return checked_stamp(stamp.sec, stamp.nanosec)
    except InputError:
        return -1


def _is_refused(door: Callable[[Any], Any], message: Any) -> bool:
    try:
        door(message)
    except InputError:
        return True
    return False


def test_what_has_a_stamp_of_the_present_is_refused_by_every_node() -> None:
    now_ns = 7 * PERIOD_NS
    hostility = Hostility(3, PERIOD_NS)
    thrown = [hostility.message(now_ns) for _ in range(N_MESSAGES)]
    present = [(t, m) for t, m in thrown if _stamp_ns(m) in (now_ns, now_ns + PERIOD_NS)]
    assert {topic for topic, _ in present} == set(DOORS)
    assert len(present) < N_MESSAGES // 50
    taken = [t for t, m in present for door in DOORS[t] if not _is_refused(door, m)]
    assert taken == []


def test_what_has_another_stamp_may_be_sound() -> None:
    hostility = Hostility(3, PERIOD_NS)
    thrown = [hostility.message(7 * PERIOD_NS) for _ in range(2000)]
    sound = {t for t, m in thrown if not any(_is_refused(door, m) for door in DOORS[t])}
    assert sound == {
        "muscle_activations",
        "muscle_command",
        "left/image_raw",
        "right/image_raw",
        "reward",
    }
