"""Randomness: a function of (seed, role, number), the same for ever, without overlaps."""

import numpy as np
import pytest

from lockstep.randomness import generator


def test_same_arguments_same_numbers() -> None:
    assert generator(1, "a", 5).random(8).tobytes() == generator(1, "a", 5).random(8).tobytes()


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


def test_numbers_do_not_overlap() -> None:
    # The stream of a number is 2^64 blocks long: the next number's is none of the first many.
    first = generator(3, "a", 0).integers(1 << 63, size=20_000)
    second = generator(3, "a", 1).integers(1 << 63, size=20_000)
    assert not np.intersect1d(first, second).size


def test_the_counter_starts_at_number_times_two_to_the_64() -> None:
    state = generator(3, "a", 7).bit_generator.state["state"]
    assert state["counter"].tolist() == [0, 7, 0, 0]


def test_large_numbers() -> None:
    assert generator(1, "a", 2**53).random() != generator(1, "a", 2**53 - 1).random()


def test_streams_of_successive_numbers_are_uncorrelated() -> None:
    # The mean of 20,000 first draws is uniform's 0.5 within 5 standard errors.
    first = np.array([generator(1, "a", number).random() for number in range(20_000)])
    standard_error = np.sqrt(1 / 12 / len(first))
    assert abs(first.mean() - 0.5) < 5 * standard_error
    assert abs(np.corrcoef(first[:-1], first[1:])[0, 1]) < 5 / np.sqrt(len(first))


def test_negative_numbers_are_refused() -> None:
    with pytest.raises(ValueError, match="number: expected 0 or more, got -1"):
        generator(1, "a", -1)
