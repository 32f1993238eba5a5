"""A run that goes on: with its own settings only, for longer, or as a new one."""

import json
import re
import shutil
from collections.abc import Callable
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pytest
import yaml

from active_binocular_vision import Run
from active_binocular_vision.commands.command_line import arguments, request_of
from active_binocular_vision.commands.evaluate import main as evaluate
from active_binocular_vision.commands.run import main as run_experiment
from experiment_manager import configuration_of, read_configuration
from experiment_manager.preparation import continuation
from experiment_manager.preparation.continuation import check_settings
from experiment_manager.run import checkpoint
from lockstep import InputError
from tests.graph_harness import OracleRun, vectors

Refused = Callable[..., str]


@pytest.fixture
def run(small_run: Path, tmp_path: Path) -> Path:
    """Return a copy of a run that has been made to its end: 60 iterations, tests at 0, 30, 60."""
    return Path(shutil.copytree(small_run, tmp_path / "run"))


@pytest.fixture
def refused(run: Path, capsys: pytest.CaptureFixture[str]) -> Refused:
    """Return a function that runs a command line in vain and returns the one line it says."""

    def refused(*line: str) -> str:
        before = {path: path.read_bytes() for path in run.rglob("*") if path.is_file()}
        assert run_experiment(line) == 2
        assert before == {path: path.read_bytes() for path in run.rglob("*") if path.is_file()}
        (error,) = capsys.readouterr().err.splitlines()
        return error

    return refused


def _edit(run: Path, old: str, new: str) -> None:
    path = run / "config.yaml"
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


@pytest.mark.parametrize(
    ("line", "has"),
    [
        (("--seed", "3"), "--seed 3: .* task.seed = 1,"),
        (("--model", "M_C"), "--model M_C: .* experiment_manager.model = M,"),
        (("--lambda", "0.2"), "--lambda 0.2: .* task.metabolic_cost_weight = 0.0,"),
        (
            ("--set", "vergence_rl.cacla.discount=0.5"),
            "discount=0.5: .* vergence_rl.cacla.discount = 0.3,",
        ),
        (("--out", "elsewhere"), "--out elsewhere: "),
        (("--stimuli", "/pictures"), "--stimuli /pictures: .* eye_plant.stimuli.directory = "),
        (("--profile", "demonstration"), "--profile demonstration: .* has profile 'paper'"),
        (("--tests", "0"), r"--tests 0: .*test_iterations = \[0, 30\],"),
    ],
)
def test_a_resumed_run_keeps_its_settings(run, refused, line, has) -> None:
    error = refused("--resume", str(run), *line)
    assert re.search(has, error)
    assert f"--branch {run} begins a new run" in error


def test_a_run_keeps_the_delay_of_its_schedule() -> None:
    line = ["--profile", "clinic/glasses", "--schedule-delay"]
    same, other = (request_of(arguments([*line, n])) for n in ("10000", "25000"))
    configuration = configuration_of(same, "0123abc")
    check_settings(same, Path("run"), configuration)
    with pytest.raises(InputError, match=r"--schedule-delay 25000: .* has schedule .*15000"):
        check_settings(other, Path("run"), configuration)


def test_settings_that_a_run_has_may_be_said_again(run: Path) -> None:
    line = ["--seed", "1", "--iterations", "60", "--model", "M", "--lambda", "0", "--tests", "0,30"]
    line += ["--set", "vergence_rl.cacla.discount=0.3", "--profile", "paper", "--out", str(run)]
    assert run_experiment(["--in-process", "--resume", str(run), *line]) == 0


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("discount: 0.3", "discount: 0.4", "vergence_rl.cacla.discount was 0.3, is 0.4"),
        (
            "camera.left_blur_px: 0.0",
            "camera.left_blur_px: 1.0",
            "eyes.camera.left_blur_px was 0.0, is 1.0",
        ),
        ("n_selections: 10", "n_selections: 9", "task.n_selections was 10, is 9"),
        ("iterations_per_trial: 4", "iterations_per_trial: 5", "iterations_per_trial was 4"),
    ],
)
def test_an_edited_configuration_is_told_by_name(run, refused, old, new, told) -> None:
    _edit(run, old, new)
    assert told in refused("--resume", str(run))


def test_what_touches_no_number_may_be_edited(run: Path) -> None:
    _edit(run, "gap_s: 5.0", "gap_s: 9.0")
    assert run_experiment(["--in-process", "--resume", str(run)]) == 0


def test_an_extended_run_has_the_numbers_of_the_new_schedule(small_run, run, monkeypatch) -> None:
    # The first time it is killed when all but config.yaml is written.
    with monkeypatch.context() as killed:
        killed.setattr(continuation, "replace_file", Mock(side_effect=KeyboardInterrupt))
        with pytest.raises(KeyboardInterrupt):
            continuation.extend(run, 40)
    assert run_experiment(["--in-process", "--resume", str(run), "--extend", "40"]) == 0
    results = json.loads((run / "results.json").read_text())
    before = json.loads((small_run / "results.json").read_text())
    assert [test["iteration"] for test in results["tests"]] == [0, 30, 60, 100]
    assert results["tests"][:3] == before["tests"]
    assert results["iterations"] == 100
    assert evaluate([str(run)]) == 0
    assert (
        yaml.safe_load((run / "config.yaml").read_text())["run"]["ros__parameters"]["extended_from"]
        == 60
    )

    manifest, states = checkpoint.everyone(small_run / "checkpoints")[-1]
    oracle = OracleRun(read_configuration(run / "config.yaml"))
    oracle.restore(states)
    truth = [s.observation.ground_truth_values() for _, s in oracle.steps(manifest.place)]
    table = vectors(run)["ground_truth"]
    np.testing.assert_array_equal(table.position[-len(truth) :], truth)
    whole = table.column("observation").tolist()
    assert whole == list(range(len(whole)))


def test_a_branch_goes_on_from_the_learners_of_another_run(run: Path, tmp_path: Path) -> None:
    out = tmp_path / "branch"
    line = ["--branch", f"{run}@60", "--iterations", "100", "--out", str(out)]
    line += ["--set", "vergence_rl.cacla.discount=0.5", "--seed", "4"]
    assert run_experiment(["--in-process", *line]) == 0
    _, states = checkpoint.everyone(run / "checkpoints")[-1]
    oracle = OracleRun(read_configuration(out / "config.yaml"))
    oracle.restore(states)
    first = oracle.protocol.place_after(60)
    truth = [s.observation.ground_truth_values() for _, s in oracle.steps(first)]
    recorded = Run(out)
    np.testing.assert_array_equal(vectors(out)["ground_truth"].position, truth)
    about = recorded.about
    assert (about["branched_from"], about["branched_at_iteration"]) == (str(run), 60)
    assert recorded.configuration["vergence_rl"]["cacla.discount"] == 0.5
    assert recorded.seed == 4
    assert evaluate([str(out)]) == 0
    results = json.loads((out / "results.json").read_text())
    assert [test["iteration"] for test in results["tests"]] == [100]
    assert results["lambda_share"] == {"first_5000": None, "last_5000": None}


def test_which_run_a_branch_begins_from(tmp_path: Path) -> None:
    for name in ("a@5", "b"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "config.yaml").touch()
    a, a_at_5, b = tmp_path / "a", tmp_path / "a@5", tmp_path / "b"
    assert continuation._source(str(b)) == (b, None)
    assert continuation._source(f"{b}@1e5") == (b, 100_000)
    with pytest.raises(InputError, match=r"a run directory or trained eyes, got .*b@²"):
        continuation._source(f"{b}@²")
    assert continuation._source(str(a_at_5)) == (a_at_5, None)
    a.mkdir()
    (a / "config.yaml").touch()
    with pytest.raises(InputError, match=r"expected one run, .*a@5 is one, and so is .*/a: write "):
        continuation._source(str(a_at_5))
    assert continuation._source(f"{a_at_5}/") == (a_at_5, None)
    assert continuation._source(f"{a}/@5") == (a, 5)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("--resume RUN --extend 15", "n_training_iterations: expected a multiple of 10"),
        ("--resume RUN --extend 0", "--extend: expected 1 or more, got 0"),
        ("--resume RUN --extend 4990", "n_training_iterations: expected 5060 or more"),
        ("--resume RUN --branch x", "--branch: expected it without --resume"),
        ("--branch RUN@70", "expected a checkpoint to begin from after 70 training iterations"),
        ("--branch gaz", "expected a run directory or trained eyes, got gaz; did you mean gaze"),
        ("--branch 20240101", "expected a run directory or trained eyes, got 20240101"),
        (
            "--branch RUN --iterations 30",
            "--iterations 30: expected 60 or more, since a branch counts on from its "
            "checkpoint, which has made 60; 90 would train for 30 more",
        ),
        ("--branch RUN --set task.n_bases=7", "atoms: expected float32 of shape (2, 7, 128)"),
        (
            "--branch RUN --set task.command_space=horizontal_recti",
            "=horizontal_recti: expected pair, with which the learners of RUN were trained",
        ),
        ("--branch RUN --profile paper", "expected the settings of RUN and single ones"),
    ],
)
def test_what_cannot_be_extended_or_branched(run, refused, tmp_path, line, message) -> None:
    words = [word.replace("RUN", str(run)) for word in line.split()]
    out = tmp_path / "out"
    error = refused(*words, *(["--out", str(out)] if "--resume" not in words else []))
    assert message.replace("RUN", str(run)) in error
    assert not out.exists()
