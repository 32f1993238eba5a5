"""Gather: one set of messages per stamp, whatever the order, and nothing kept for ever."""

import itertools

import pytest

from lockstep.node.gather import Gather


@pytest.mark.parametrize("order", list(itertools.permutations("abc")))
def test_complete_in_any_order(order: tuple[str, ...]) -> None:
    gather = Gather(("a", "b", "c"))
    assert gather.add(order[0], 5, 1) is None
    assert gather.add(order[1], 5, 2) is None
    assert gather.add(order[2], 5, 3) == {order[0]: 1, order[1]: 2, order[2]: 3}


def test_one_topic_is_complete_at_once() -> None:
    assert Gather(("a",)).add("a", 0, "x") == {"a": "x"}


def test_a_repeated_message_replaces_the_first() -> None:
    gather = Gather(("a", "b"))
    gather.add("a", 1, "old")
    gather.add("a", 1, "new")
    assert gather.add("b", 1, "b") == {"a": "new", "b": "b"}


def test_the_complete_stamp_may_come_again() -> None:
    gather = Gather(("a", "b"))
    for _ in range(3):
        assert gather.add("a", 4, 1) is None
        assert gather.add("b", 4, 2) == {"a": 1, "b": 2}


def test_stamps_never_mix() -> None:
    gather = Gather(("a", "b"))
    assert gather.add("a", 1, "a1") is None
    assert gather.add("b", 2, "b2") is None
    assert gather.add("a", 2, "a2") == {"a": "a2", "b": "b2"}


def test_older_than_the_complete_one_is_ignored() -> None:
    gather = Gather(("a", "b"))
    gather.add("a", 9, 1)
    gather.add("b", 9, 2)
    assert gather.add("a", 8, 1) is None
    assert gather.add("b", 8, 2) is None


def test_a_stamp_of_the_far_future_blocks_nobody() -> None:
    gather = Gather(("a", "b"))
    assert gather.add("a", 1 << 62, "hostile") is None
    assert gather.add("a", 3, 1) is None
    assert gather.add("b", 3, 2) == {"a": 1, "b": 2}


def test_incomplete_sets_are_bounded() -> None:
    gather = Gather(("a", "b"))
    for stamp_ns in range(1000):
        gather.add("a", stamp_ns, "big")
    assert gather.add("b", 0, 2) is None, "the first has been forgotten"
    assert gather.add("b", 999, 2) == {"a": "big", "b": 2}


def test_completing_a_stamp_drops_the_incomplete_older_ones() -> None:
    gather = Gather(("a", "b"))
    gather.add("a", 1, 1)
    gather.add("a", 2, 1)
    gather.add("b", 2, 2)
    assert gather.add("b", 1, 2) is None


def test_after_a_reset_stamps_start_anew() -> None:
    gather = Gather(("a", "b"))
    gather.add("a", 9, "old run")
    gather.add("b", 9, "old run")
    gather.add("a", 10, "old run")
    gather.reset()
    assert gather.add("b", 10, 2) is None
    assert gather.add("a", 0, 1) is None
    assert gather.add("b", 0, 2) == {"a": 1, "b": 2}


def test_a_topic_is_held_while_others_of_its_stamp_are_missing() -> None:
    gather = Gather(("a", "b"))
    assert not gather.holds("a")
    gather.add("a", 1, 1)
    assert gather.holds("a")
    assert not gather.holds("b")
    gather.add("b", 1, 2)
    assert not gather.holds("a")
