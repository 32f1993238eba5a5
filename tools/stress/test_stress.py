"""Hostile input is hostile, kills are done, and no problem is lost."""

import json
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from signal import SIGKILL
from typing import Any
from unittest import mock

import numpy as np
import pytest

from experiment_manager.nodes import NODES
from eye_plant.commands import target_activations
from lockstep import COMMAND_SPACES, MUSCLE_NAMES, PAIR, InputError
from lockstep.wire.stamps import checked_stamp
from lockstep.wire.topics import EPISODE_NAMES, PICTURES
from lockstep.wire.vectors import values_of, whole_values_of
from sparse_coder.messages import picture_of
from tests.pair import HORIZONTAL_RECTI
from tools.stress import __main__ as torture
from tools.stress import hostile_input, kills
from tools.stress.fuzzer import Hostility
from tools.stress.kills import disturb
from vergence_rl.messages import activations_of, features_of

PERIOD_NS = 200_000_000


def _command(message: Any) -> None:
    values = values_of(message, message.name, "muscle_command")
    target_activations(message.name, values, np.zeros(len(MUSCLE_NAMES)))


def _picture(message: Any) -> None:
    if picture_of(message, "picture").shape != (240, 320):
        raise InputError("the coder looks at the size")


def _features(message: Any) -> None:
    if features_of(message, 2).shape[1] != 32:
        raise InputError("the agent looks at the size")


# What each node that takes a message does with it first.
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
        return checked_stamp(message.header.stamp.sec, message.header.stamp.nanosec)
    except InputError:
        return -1


def _is_refused(door: Callable[[Any], Any], message: Any) -> bool:
    try:
        door(message)
    except InputError:
        return True
    return False


def test_what_has_a_stamp_of_the_present_is_refused_by_every_node() -> None:
    now_ns, n_messages = 7 * PERIOD_NS, 6000
    hostility = Hostility(3, PERIOD_NS)
    thrown = [hostility.message(now_ns) for _ in range(n_messages)]
    present = [(t, m) for t, m in thrown if _stamp_ns(m) in (now_ns, now_ns + PERIOD_NS)]
    assert {topic for topic, _ in present} == set(DOORS)
    assert len(present) < n_messages // 50
    assert [t for t, m in present for door in DOORS[t] if not _is_refused(door, m)] == []


def test_what_has_another_stamp_may_be_sound() -> None:
    hostility = Hostility(3, PERIOD_NS)
    thrown = [hostility.message(7 * PERIOD_NS) for _ in range(2000)]
    sound = {t for t, m in thrown if not any(_is_refused(door, m) for door in DOORS[t])}
    assert sound == {
        *("muscle_activations", "muscle_command", "reward"),
        *("left/image_raw", "right/image_raw"),
    }


def test_two_nodes_of_a_place_are_killed_and_no_third() -> None:
    run = mock.Mock(**{"place.return_value": -1, "pause.return_value": True})
    draw = mock.Mock(**{"uniform.return_value": 0.0, "random.return_value": 0.0})
    draw.choice.side_effect = NODES
    done_at = Counter[int]()
    first, second, *others = [disturb(run, draw, done_at) for _ in NODES]
    assert (first, second) == (f"{NODES[0]} killed", f"{NODES[1]} killed")
    assert set(others) == {""}
    assert run.signal_node.call_args_list == [mock.call(name, SIGKILL) for name in NODES[:2]]
    run.kill.assert_not_called()  # before the first checkpoint there is nothing to resume


def test_a_part_that_cannot_go_on_is_a_problem_and_keeps_no_other_from_its_work(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(kills, "kill", mock.Mock(side_effect=TimeoutError("waited in vain")))
    monkeypatch.setattr(
        hostile_input, "fuzz", mock.Mock(return_value=({"inputs": 3}, ["one differed"]))
    )
    path = tmp_path / "found.json"
    assert torture.main(["--kills", "2", "--inputs", "3", "--json", str(path)]) == 1
    assert json.loads(path.read_text()) == {
        "seed": 1,
        "inputs": {"inputs": 3},
        "problems": ["kills: TimeoutError: waited in vain", "inputs: one differed"],
    }
    monkeypatch.setattr(hostile_input, "fuzz", mock.Mock(return_value=({"inputs": 3}, [])))
    assert torture.main(["--kills", "0", "--inputs", "3"]) == 0
