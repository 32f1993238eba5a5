"""The first lines of a run."""

from pathlib import Path

from experiment_manager.preparation.command_line import arguments, request_of
from experiment_manager.preparation.configuration import configuration_of
from experiment_manager.preparation.plan import plan


def _plan(*line: str) -> list[str]:
    return plan(configuration_of(request_of(arguments(line)), ""))


def test_the_papers_tests_and_how_long_they_take() -> None:
    # K17: 13 tests of 39 conditions x 40 stimuli, 20 iterations each.
    (line,) = _plan("--profile", "paper")
    assert line.startswith("1,000,000 training iterations, and 13 tests of 1,560 trials: 405,600 ")
    assert "about 27.0 minutes at 250 iterations/s (--test-stimuli K makes tests shorter)" in line


def test_what_is_done_instead_is_one_line(pictures: Path) -> None:
    _, left_out, stimuli = _plan("--iterations", "60000", "--stimuli", str(pictures))
    assert left_out == (
        "training ends at 60,000: the tests from 100,000 on are left out, one is made at the end"
    )
    assert stimuli == (
        f"{pictures}: 3 pictures to train with and 2 to test with, in place of 100 and 40"
    )
