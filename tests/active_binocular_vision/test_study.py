"""Runs from Python: the same as those of the command line, as data frames."""

import signal
import threading
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from msgspec.structs import replace

import active_binocular_vision as abv
from active_binocular_vision.examinations.registry import EXAMINATIONS
from active_binocular_vision.learners.basis_functions import tunings
from active_binocular_vision.runs.frames import frame_of_basis_functions
from experiment_manager import Summary
from eye_plant import EyePlantConfig
from lockstep import InputError
from lockstep.scales import ScalesConfig
from tests.active_binocular_vision.learners.gabor_patch import shifted_wave
from tests.patience import PATIENCE_S


class Stopped(Exception):  # noqa: N818 (as Optuna's TrialPruned)
    """What a callback raises."""


@pytest.fixture
def of_command_line(run_of: Callable[[str], Path]) -> abv.Run:
    """Return a run that `abv run` made."""
    return abv.Run(run_of("pair"))


def _run(directory: Path, like: abv.Run, **options: object) -> abv.Run:
    """Make the same run from Python."""
    about = like.configuration
    settings = {
        "eye_plant.stimuli.size_px": about["eye_plant"]["stimuli.size_px"],
        "experiment_manager.test_distances_m": (2.0,),
        "task.n_bases": 32,
    }
    stimuli = about["eye_plant"]["stimuli.directory"]
    return abv.run(
        "precise",
        iterations=40,
        tests=(0, 40),
        stimuli=stimuli,
        settings=settings,
        out=directory,
        **options,  # type: ignore[arg-type]
    )


def test_a_run_from_python_is_that_of_the_command_line_and_can_be_stopped_and_resumed(
    tmp_path: Path, of_command_line: abv.Run
) -> None:
    def stop(test: Summary) -> None:
        raise Stopped(test.iteration)

    before = signal.getsignal(signal.SIGINT)
    with pytest.raises(Stopped, match=r"^0$"):
        _run(tmp_path / "run", of_command_line, on_test=stop)
    assert signal.getsignal(signal.SIGINT) is before
    made: list[abv.Run] = []
    seen: list[Summary] = []

    def resume() -> None:
        # As where a framework starts it: another thread gets no signals.
        made.append(_run(tmp_path / "run", of_command_line, on_test=seen.append, resume=True))

    thread = threading.Thread(target=resume)
    thread.start()
    thread.join(PATIENCE_S)
    assert tuple(seen)[-1] == of_command_line.summaries[-1]
    assert made[0].results.equals(of_command_line.results)
    assert made[0].trials.equals(of_command_line.trials)
    assert np.array_equal(made[0].basis_functions(), of_command_line.basis_functions())
    again = _run(tmp_path / "run", of_command_line, on_test=stop, resume=True)
    assert again.results.equals(of_command_line.results)
    with pytest.raises(InputError, match=r"^seed: the run to be resumed, .* has task.seed = 1"):
        _run(tmp_path / "run", of_command_line, seed=7, resume=True)
    with pytest.raises(InputError, match="expected a new or empty directory"):
        _run(tmp_path / "run", of_command_line)


def test_a_run_goes_on_from_another(tmp_path: Path, of_command_line: abv.Run) -> None:
    begun = abv.run(
        branch=of_command_line.directory, iterations=60, tests=[60], out=tmp_path / "run"
    )
    assert begun.results.index.tolist() == [60]
    with pytest.raises(InputError, match="expected 40 or more"):
        abv.run(branch=of_command_line.directory, iterations=20, out=tmp_path / "too_few")


def test_results_have_a_row_per_test_and_trials_one_per_trial(of_command_line: abv.Run) -> None:
    run = of_command_line
    assert run.results.index.tolist() == [0, 40]
    last = run.summaries[-1]
    row = run.results.loc[40]
    assert row["share_within_1_px"] == last.share_within_1_px
    near = last.starts_up_to_2_deg.median_delta_cost_w
    assert row["starts_up_to_2_deg.median_delta_cost_w"] == pytest.approx(near)
    of_test = run.trials.query("iteration == 40")
    assert len(of_test) == last.n_trials
    errors_deg = run.tests[40].vergence_error_deg
    assert np.array_equal(of_test["start_error_deg"], errors_deg[:, 0])
    assert np.array_equal(of_test["vergence_error_deg"], errors_deg[:, -1])
    median_deg = of_test["vergence_error_deg"].abs().median()
    assert median_deg == pytest.approx(last.median_abs_vergence_error_deg)
    assert np.array_equal(of_test["medial_rectus"], run.tests[40].activations[:, -1, 0])


def test_basis_functions_are_pictures_of_each_eye(of_command_line: abv.Run) -> None:
    functions = of_command_line.basis_functions()
    assert functions.shape == (2, 32, 2, 8, 8)
    learners = of_command_line.learners()
    assert np.array_equal(functions[1, 3, 1], learners.atoms[1, 3, 64:].reshape(8, 8))
    assert of_command_line.learners(40).place == learners.place
    with pytest.raises(InputError, match="expected a checkpoint after 7 training iterations"):
        of_command_line.learners(7)


def test_compared_runs_show_the_settings_in_which_they_differ(
    of_command_line: abv.Run, run_of: Callable[[str], Path]
) -> None:
    frame = abv.compare([of_command_line, run_of("gaze")])
    assert frame["profile"].tolist() == ["precise", "gaze"]
    assert frame["task.command_space"].tolist() == ["pair", "all_muscles"]
    assert "task.n_bases" not in frame
    assert frame["share_within_1_px"].iloc[0] == of_command_line.summaries[-1].share_within_1_px
    assert abv.compare([]).empty
    untested = abv.Run(of_command_line.directory)
    untested.document = replace(untested.document, tests=())
    found = abv.compare([untested, of_command_line])
    assert found["n_trials"].isna().tolist() == [True, False]


@pytest.mark.parametrize(
    ("examination", "options", "message"),
    [
        ("covr", {}, "examination: expected a known name, got 'covr'; did you mean cover"),
        ("cover", {"distances": (2.0,)}, "unknown parameter distances: did you mean distances_m"),
        (
            "cover",
            {"settings": {"mechanics.strength": [1.0] * 12}},
            r"settings: expected names that begin with eyes\., got mechanics\.strength",
        ),
    ],
)
def test_an_examination_that_cannot_be_made_is_refused(
    examination: str, options: dict[str, Any], message: str, of_command_line: abv.Run
) -> None:
    with pytest.raises(InputError, match=message):
        abv.examine(of_command_line, examination, **options)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("iteration", "options of abv.run: .* got 'iteration'; did you mean iterations"),
        ("setings", "got 'setings'; did you mean settings"),
        ("overrides", "options of abv.run: expected .* got 'overrides'"),
    ],
)
def test_an_unknown_option_of_a_run_is_refused(tmp_path: Path, name: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        abv.run("precise", out=tmp_path / "run", **{name: 1})  # type: ignore[arg-type]
    assert not (tmp_path / "run").exists()


def test_names_of_trained_eyes_are_suggested() -> None:
    for part in (
        lambda: abv.examine("demonstraton", "cover"),
        lambda: abv.Run("demonstraton").profile,
        lambda: abv.Run("demonstraton").results,
    ):
        with pytest.raises(InputError, match="got demonstraton; did you mean demonstration"):
            part()


def test_basis_functions_have_a_row_each_of_what_they_are_tuned_to() -> None:
    # Vertical stripes of 6 pixels of the scale, shifted by 1; a pixel is 0.2226 deg, of the coarse
    # scale 4 of them, of the foveal one a quarter.
    scales = ScalesConfig(
        ("coarse", "fine", "foveal"), (128, 40, 40), (32, 40, 40), (1.0, 1.0, 4.0), (0.0,) * 3
    )
    learners = SimpleNamespace(
        plant=EyePlantConfig(),
        manager=SimpleNamespace(scales=scales),
        tunings=tunings(np.stack([[shifted_wave(1.0)]] * 3), scales),
    )
    frame = frame_of_basis_functions(learners).set_index("scale")  # type: ignore[arg-type]
    for scale, px in (("coarse", 4.0), ("fine", 1.0), ("foveal", 0.25)):
        row = frame.loc[scale]
        assert row["is_gabor"]
        assert row["orientation_deg"] == pytest.approx(90.0, abs=1.0)
        assert row["frequency_cycles_per_deg"] == pytest.approx(1 / (6 * px * 0.2226), rel=0.02)
        assert row["disparity_deg"] == pytest.approx(px * 0.2226, rel=0.05)
        # A sixth of a wave: the other half responds cos(60 deg) = 1/2 as much.
        assert abs(row["binocularity"]) == pytest.approx(1 / 3, abs=0.02)


def test_eyes_are_examined_with_other_cameras_too(of_command_line: abv.Run) -> None:
    blurred = {"eyes.camera.right_blur_px": 4.0}
    options: dict[str, Any] = {"test_stimuli": 1, "distances_m": (2.0,)}
    own, other = (
        abv.examine(of_command_line, "acuity", settings=settings, **options)
        for settings in (None, blurred)
    )
    assert own.measures()["n_stimuli"] == other.measures()["n_stimuli"] == 1
    assert own.measures() != other.measures()
    again = abv.examine(of_command_line, EXAMINATIONS["acuity"], **options)
    assert again.measures() == own.measures()
    frames = own.frames()
    assert len(frames["summary"]) == 1
    assert len(frames["eyes"]) == 2
    for name, rows in own.tables.items():
        assert len(frames[name]) == len(rows)
