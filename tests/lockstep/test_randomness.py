"""Randomness: a function of (seed, role, number), the same for ever, without overlaps."""

import pytest

from lockstep import generator


def test_golden_values() -> None:
    # Written down once: a change of these numbers is a change of every published result.
    draw = generator(1, "episode", 0)
    assert draw.integers(100) == 21
    assert draw.random() == 0.2750167749529826
    assert generator(1, "exploration", 12345).standard_normal() == -1.4590404394894159


def test_seed_role_and_number_each_matter() -> None:
    draws = {
        generator(seed, role, number).bytes(16)
        for seed in (-1, 0, 1)
        for role in ("a", "b")
        for number in range(50)
    }
    assert len(draws) == 3 * 2 * 50


def test_seed_and_role_do_not_run_together() -> None:
    assert generator(1, "2/a", 0).bytes(16) != generator(12, "/a", 0).bytes(16)


def test_the_counter_starts_at_number_times_two_to_the_64() -> None:
    state = generator(3, "a", 7).bit_generator.state["state"]
    assert state["counter"].tolist() == [0, 7, 0, 0]


def test_negative_numbers_are_refused() -> None:
    with pytest.raises(ValueError, match="number: expected 0 or more, got -1"):
        generator(1, "a", -1)
