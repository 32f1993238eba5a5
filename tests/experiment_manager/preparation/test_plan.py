"""The first lines of a run."""

from pathlib import Path

from active_binocular_vision.runs.results_folder import runs_at
from experiment_manager.measures.results import Summary
from experiment_manager.preparation.plan import plan, preparation
from eye_plant.stimuli.stimulus_set import StimuliConfig, load_stimuli
from tests.command_lines import configured

RESULTS = Path(__file__).parents[3] / "results"


def _plan(*line: str, place: int = 0) -> list[str]:
    return plan(configured(*line), place)


def test_the_papers_tests_and_how_long_they_take() -> None:
    # K17: 13 tests of 39 conditions x 40 stimuli, 20 iterations each.
    (line,) = _plan("--profile", "paper")
    assert line == (
        "1,000,000 training iterations, and 405,600 in 13 tests of 1,560 trials: together about "
        "94 minutes at 250 iterations/s (--test-stimuli K makes tests shorter)"
    )


def test_one_test_is_one() -> None:
    line, _ = _plan("--iterations", "2000", "--tests", "2000", "--test-stimuli", "1")
    assert line.startswith("2,000 training iterations, and 780 in 1 test of 39 trials: together ")
    assert "about 11 seconds" in line


def test_a_run_that_goes_on_says_what_is_left() -> None:
    # Two tests of 39 trials, and between them 1,000 episodes of 10 iterations.
    words = "--profile demonstration --iterations 10000 --tests 0 --test-stimuli 1"
    line = words.split()
    done = "left: 10,000 of 10,000 training iterations, and 820 in 41 trials of tests: "
    assert _plan(*line, place=37)[0] == done + "together about 43 seconds at 250 iterations/s"
    done = "left: 9,990 of 10,000 training iterations, and 780 in 39 trials of tests: "
    assert _plan(*line, place=40)[0] == done + "together about 43 seconds at 250 iterations/s"
    done = "left: 0 of 10,000 training iterations, and 20 in 1 trial of tests: "
    assert _plan(*line, place=1077)[0] == done + "together about 0 seconds at 250 iterations/s"
    assert _plan(*line, place=1078)[0] == (
        "nothing is left: all 10,000 training iterations and all tests are done"
    )


def test_how_the_pictures_are_got(pictures: Path, tmp_path: Path) -> None:
    assert preparation(StimuliConfig(directory=str(pictures))) == (
        f"reading the pictures of {pictures}"
    )
    cache = str(tmp_path)
    assert preparation(StimuliConfig(cache_directory=cache, n_training=100, n_test=40)) == (
        "generating 140 stimuli, which are kept for later runs (about 60 seconds)"
    )
    assert preparation(StimuliConfig(cache_directory=cache, n_training=1000, n_test=400)) == (
        "generating 1,400 stimuli, which are kept for later runs (about 10 minutes)"
    )
    two = StimuliConfig(cache_directory=cache, size_px=64, n_training=1, n_test=1)
    assert preparation(two) == "generating 2 stimuli, which are kept for later runs (some seconds)"
    load_stimuli(two)
    assert preparation(two) == ""
    three = StimuliConfig(cache_directory=cache, size_px=64, n_training=2, n_test=1)
    assert preparation(three) == (
        "generating 1 stimulus, which is kept for later runs (some seconds)"
    )


def test_a_run_that_is_too_short_to_learn_says_how_long_it_takes() -> None:
    _, said, *_ = _plan("--model", "M_C", "--iterations", "2000")
    assert said == (
        "that is too short to learn much: in the runs of results/ with this learning rule (cacla), "
        "vergence was learned after 50,000 training iterations, and energy saved after 200,000"
    )
    _, said = _plan("--profile", "precise", "--iterations", "5000", "--tests", "0")
    assert said.endswith("(hindsight), vergence was learned after 10,000 training iterations")


def _tests(sweep: str, iteration: int, *models: str) -> list[Summary]:
    """Return the tests of a sweep's runs after so many training iterations."""
    tests = [t for run in runs_at(RESULTS / sweep) if run.model in models for t in run.summaries]
    return [test for test in tests if test.iteration == iteration]


def test_the_runs_of_results_had_learned_by_then() -> None:
    for sweep, iteration in (("demonstration", 10_000), ("paper", 50_000)):
        tests = _tests(sweep, iteration, "M", "M_C")
        errors_deg = [test.median_abs_vergence_error_deg or 0.0 for test in tests]
        assert len(errors_deg) >= 3
        assert max(errors_deg) < 0.4
    for sweep, iteration in (("demonstration", 50_000), ("paper_short", 200_000)):
        savings = [t.median_cost_reduction or 0.0 for t in _tests(sweep, iteration, "M_C")]
        assert len(savings) >= 2
        assert min(savings) > 0.1


def test_what_is_done_instead_is_one_line(pictures: Path) -> None:
    _, left_out, stimuli = _plan("--iterations", "60000", "--stimuli", str(pictures))
    assert left_out == (
        "training ends at 60,000: the tests from 100,000 on are left out, one is made at the end"
    )
    assert stimuli == (
        f"{pictures}: 3 pictures to train with and 2 to test with, in place of 100 and 40"
    )
