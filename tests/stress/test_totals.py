"""Slices of the torture add up, whenever it is broken off; a hail is reduced to what bites."""

from pathlib import Path

import pytest

from lockstep.errors import InputError
from tests.stress.smallest_failing_input import smallest
from tests.stress.totals import Totals


def test_slices_add_up_over_several_starts(tmp_path: Path) -> None:
    path = tmp_path / "totals.json"
    first = {"runs": 2, "by_kind": {"plant killed": 3}, "longest_s": 45.0}
    Totals(path, 1).add("kills", 10, first, [])
    second = {"runs": 1, "by_kind": {"plant killed": 1, "plant stopped": 2}, "longest_s": 2.0}
    Totals(path, 1).add("kills", 5, second, ["one differed"])
    found = Totals(path, 1).of("kills")
    assert (found.n_slices, found.n_done, found.problems) == (2, 15, ["one differed"])
    assert found.figures == {
        "runs": 3,
        "by_kind": {"plant killed": 4, "plant stopped": 2},
        "longest_s": 45.0,
    }
    assert Totals(path, 1).of("cuts").n_done == 0


def test_totals_of_another_seed_and_files_of_others_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "totals.json"
    Totals(path, 1).add("kills", 1, {}, [])
    with pytest.raises(InputError, match="expected totals of seed 2, got those of seed 1"):
        Totals(path, 2)
    path.write_text('{"seed": 1}')
    with pytest.raises(InputError, match="expected totals of torture"):
        Totals(path, 1)


@pytest.mark.parametrize("culprits", [{0}, {99}, {41}, {3, 97}, {10, 11, 12}, {0, 33, 66, 99}])
def test_the_fewest_inputs_that_bite_together_are_found(culprits: set[int]) -> None:
    n_tries = 0

    def bites(some: object) -> bool:
        nonlocal n_tries
        n_tries += 1
        return culprits <= set(some)  # type: ignore[call-overload]

    assert set(smallest(range(100), bites)) == culprits
    # Each try is a graph of its own.
    assert n_tries <= 60 * len(culprits)
