"""Gather: one set of messages per stamp, whatever the order, and nothing kept for ever."""

import itertools

import pytest

from lockstep.node.gather import N_PENDING, Gather


def _completed(gather: Gather, messages: str) -> list[int]:
    """Add messages, each a topic's letter and a stamp; return the stamps that they complete."""
    found = []
    for message in messages.split():
        topic, stamp_ns = message[0], int(message[1:])
        if (observation := gather.add(topic, stamp_ns, message)) is not None:
            assert observation == {t: f"{t}{stamp_ns}" for t in observation}
            found.append(stamp_ns)
    return found


@pytest.mark.parametrize("order", list(itertools.permutations("abc")))
def test_complete_in_any_order(order: tuple[str, ...]) -> None:
    gather = Gather("abc")
    assert _completed(gather, " ".join(f"{topic}5" for topic in order[:2])) == []
    assert _completed(gather, f"{order[2]}5") == [5]


@pytest.mark.parametrize(
    ("messages", "stamps"),
    [
        ("a4 b4 a4 b4 a4 b4", [4, 4, 4]),  # the complete one may come again
        ("a1 b2 a2", [2]),  # stamps never mix
        ("a9 b9 a8 b8", [9]),  # an older one is ignored
        ("a1 a2 b2 b1", [2]),  # and its messages are dropped
        (f"a{1 << 62} a3 b3", [3]),  # one of the far future blocks nobody
    ],
)
def test_each_stamp_for_itself(messages: str, stamps: list[int]) -> None:
    assert _completed(Gather("ab"), messages) == stamps


def test_one_topic_is_complete_at_once_and_the_last_message_counts() -> None:
    assert Gather("a").add("a", 0, "x") == {"a": "x"}
    gather = Gather("ab")
    gather.add("a", 1, "old")
    gather.add("a", 1, "new")
    assert gather.add("b", 1, "b") == {"a": "new", "b": "b"}


def test_incomplete_sets_are_bounded() -> None:
    gather = Gather("ab")
    assert _completed(gather, " ".join(f"a{i}" for i in range(N_PENDING + 1))) == []
    assert _completed(gather, f"b0 a{N_PENDING} b{N_PENDING}") == [N_PENDING]


def test_after_a_reset_stamps_start_again() -> None:
    gather = Gather("ab")
    assert _completed(gather, "a9 b9 a10") == [9]
    gather.reset()
    assert _completed(gather, "b10 a0 b0") == [0]


def test_a_topic_is_held_while_others_of_its_stamp_are_missing() -> None:
    gather = Gather("ab")
    assert not gather.holds("a")
    gather.add("a", 1, 1)
    assert gather.holds("a")
    assert not gather.holds("b")
    gather.add("b", 1, 2)
    assert not gather.holds("a")
