"""evaluate.sh with a checkpoint: what frozen learners do with their own and with other pictures."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import msgspec
import numpy as np
import pytest
from msgspec import to_builtins

from active_binocular_vision import FrozenLearners
from active_binocular_vision.commands.examine import main
from active_binocular_vision.learners.evaluation import FrozenResults, evaluated
from active_binocular_vision.learners.shown import OWN_TEST_STIMULI, Shown
from experiment_manager.measures.results import Summary, read_results
from lockstep import InputError


@pytest.fixture
def run(small_run: Path, tmp_path: Path) -> Path:
    """What a checkpoint copied to another machine has: no bag."""
    directory = tmp_path / "run"
    shutil.copytree(small_run, directory, ignore=shutil.ignore_patterns("bag", "results.json"))
    return directory


def _evaluated(run: Path, shown: Shown = OWN_TEST_STIMULI, **which: Any) -> FrozenResults:
    return evaluated(FrozenLearners(run, **which), shown)


def _tests(run: Path) -> tuple[Summary, ...]:
    return read_results(run / "results.json").tests


def test_the_last_checkpoint_on_its_own_stimuli_gives_the_last_test(small_run, run) -> None:
    assert _evaluated(run).test == _tests(small_run)[-1]


def test_eyes_with_lenses_do_as_in_their_last_test(run_of: Callable[[str], Path]) -> None:
    run = run_of("triad")
    assert _evaluated(run).test == _tests(run)[-1]


def test_own_stimuli_from_their_directory_are_the_same(small_run, run, pictures, tmp_path, capsys):
    out = tmp_path / "out.json"
    assert main([str(run), "--stimuli", str(pictures), "--json", str(out)]) == 0
    document = json.loads(out.read_text())
    assert document["tests"] == [to_builtins(_tests(small_run)[-1])]
    assert document["stimuli"] == str(pictures)
    text = capsys.readouterr().out
    assert f"2 stimuli of {pictures}" in text
    assert "{" not in text
    assert main([str(run), "--stimuli", str(pictures), "--json", "-"]) == 0
    assert json.loads(capsys.readouterr().out) == document


def test_the_first_checkpoint_gives_the_first_test(small_run: Path, run: Path) -> None:
    # The one before the first episode: nothing learned, and the test at 0 is what comes next.
    places = sorted(int(path.name) for path in (run / "checkpoints").iterdir())
    assert places[0] == 0
    assert _evaluated(run, n_episodes=0).test == _tests(small_run)[0]


def test_other_pictures_and_fewer_of_them(run: Path, tmp_path: Path) -> None:
    other = tmp_path / "other"
    other.mkdir()
    draw = np.random.default_rng(2)
    for i in range(3):
        cv2.imwrite(str(other / f"{i}.png"), draw.integers(0, 256, (80, 90), dtype=np.uint8))
    results = _evaluated(run, Shown(stimuli=other, n_most=1))
    n_conditions = results.test.n_trials
    assert (results.n_stimuli, n_conditions) == (1, 5)
    # As many as in the run's own tests, of which there were two.
    assert _evaluated(run, Shown(stimuli=other)).test.n_trials == 2 * n_conditions


@pytest.mark.parametrize(
    ("line", "message"),
    [
        (("--checkpoint", "7"), "checkpoints: expected a checkpoint after 7 episodes, there is"),
        (("--stimuli", "/nowhere"), "expected a directory of images, got /nowhere"),
        (("--stimuli", ".", "--test-stimuli", "0"), "test stimuli: expected 1 or more"),
        (("--start-scale", "0"), "start_scale: expected a run with a command for each muscle"),
    ],
)
def test_what_cannot_be_tested_is_one_line(run, line, message, capsys) -> None:
    assert main([str(run), *line]) == 2
    error = capsys.readouterr().err
    assert error.startswith("error: ")
    assert message in error
    assert error.count("\n") == 1


def test_the_start_errors_of_the_authors_code(run: Path) -> None:
    results = evaluated(FrozenLearners(run), Shown(n_most=1), start_errors="code")
    n_distances = len(results.test.bias_by_distance_deg)
    assert results.test.n_trials == 7 * n_distances
    assert results.test.without_zero_start_error.n_trials == 6 * n_distances
    assert results.to_json()["start_errors"] == "code"


def test_a_damaged_state_is_one_line(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (newest,) = sorted((run / "checkpoints").iterdir())[-1:]
    (newest / "vergence_rl.npz").write_bytes(b"")
    assert main([str(run), "--checkpoint", newest.name]) == 2
    assert "vergence_rl.npz is missing or was changed" in capsys.readouterr().err


def test_a_run_without_checkpoints_is_one_line(run, capsys) -> None:
    shutil.rmtree(run / "checkpoints")
    assert main([str(run), "--stimuli", "."]) == 2
    assert "expected a checkpoint, found none" in capsys.readouterr().err


def test_a_test_with_altered_input_is_another_one(small_run: Path, run: Path) -> None:
    same = _evaluated(run, settings={"camera.left_blur_px": 0.0})
    assert same.test == _tests(small_run)[-1]
    blurred = _evaluated(run, settings={"camera.left_blur_px": 40.0})
    assert blurred.learners.settings == {"camera.left_blur_px": 40.0}
    assert blurred.test != same.test
    # No change of a run, but one for a test: the coder is made with it.
    noisy = _evaluated(run, settings={"noise.picture_sd": 50.0, "noise.turn_sd_deg": 1.0})
    assert noisy.test != same.test


def test_random_dot_stereograms(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([str(run), "--random-dots", "--test-stimuli", "2"]) == 0
    assert "2 stimuli of random-dot stereograms" in capsys.readouterr().out


def test_generated_stimuli_of_a_run_that_was_trained_on_others(run: Path) -> None:
    results = _evaluated(run, Shown(n_most=1, generated=True))
    assert (results.n_stimuli, results.stimuli) == (1, "the generated test stimuli")
    assert results.test != _evaluated(run, Shown(n_most=1)).test


def test_stereograms_of_a_directory(run: Path, tmp_path: Path) -> None:
    directory = tmp_path / "pairs"
    directory.mkdir()
    draw = np.random.default_rng(3)
    for side in ("left", "right"):
        picture = draw.integers(0, 256, (80, 80), dtype=np.uint8)
        cv2.imwrite(str(directory / f"a_{side}.png"), picture)
    results = _evaluated(run, Shown(stereograms=directory))
    assert (results.n_stimuli, results.stimuli) == (1, str(directory))


def test_dictionary_and_actor_of_another_age(small_run: Path, run: Path) -> None:
    first, *_ = sorted((run / "checkpoints").iterdir())
    oldest = _evaluated(run, n_episodes=int(first.name)).test
    both = _evaluated(run, dictionary=first, actor=first)
    assert both.to_json()["dictionary"] == both.to_json()["actor"] == str(first)
    # All but its age is that of the first test.
    assert both.test == msgspec.structs.replace(oldest, iteration=60)
    mixed = _evaluated(run, dictionary=first).test
    assert mixed != _tests(small_run)[-1]
    assert mixed != both.test


def test_a_setting_that_is_not_the_plants_is_refused(run, capsys) -> None:
    assert main([str(run), "--set", "vergence_rl.cacla.discount=0.1"]) == 2
    assert "expected each eyes.NAME=VALUE" in capsys.readouterr().err
    assert main([str(run), "--set", "eyes.camera.width_px=64"]) == 2
    assert "camera.width_px: expected the same for a whole run" in capsys.readouterr().err


def test_two_kinds_of_stimuli_are_refused(run: Path, pictures: Path) -> None:
    with pytest.raises(
        InputError, match="expected one of a directory, stereograms, random dots and"
    ):
        _evaluated(run, Shown(stimuli=pictures, random_dots=True))


@pytest.fixture
def twelve(run_of: Callable[[str], Path]) -> Path:
    return run_of("twelve")


def test_twelve_muscles_are_tested_as_in_their_run_and_from_farther_off(twelve: Path) -> None:
    own = _evaluated(twelve)
    assert own.test == _tests(twelve)[-1]
    # Without learning the eyes stay where the trials begin.
    farther = evaluated(FrozenLearners(twelve, n_episodes=0), start_scale=1.5)
    with pytest.raises(InputError, match="start_errors: expected a run of the pair"):
        evaluated(FrozenLearners(twelve, n_episodes=0), start_errors="code")
    near_deg, far_deg = (
        summary.median_abs_cyclovergence_error_deg for summary in (_tests(twelve)[0], farther.test)
    )
    assert near_deg is not None
    assert far_deg == pytest.approx(1.5 * near_deg, rel=1e-3)


def test_a_muscle_may_be_lost_before_a_test_of_twelve(twelve: Path) -> None:
    strength = [0.0, *[1.0] * 11]
    lost = _evaluated(twelve, settings={"mechanics.strength": strength})
    assert lost.test.n_trials == _tests(twelve)[-1].n_trials
    assert lost.test != _tests(twelve)[-1]
