"""What run_experiment.sh refuses before anything is written, and how it says how to go on."""

import shutil
from collections.abc import Callable
from dataclasses import replace

import pytest

from active_binocular_vision.commands import run as run_command
from active_binocular_vision.commands.run import concluded, main, prepare_new
from experiment_manager import RunRequest, read_configuration
from experiment_manager.run import hold
from lockstep import InputError
from lockstep.exit_codes import EXIT_DIVERGED, EXIT_FAULT, EXIT_INTERRUPTED


def refused(capsys: pytest.CaptureFixture[str], *words: str) -> str:
    assert main(words) == 2
    (error,) = capsys.readouterr().err.splitlines()
    return error


@pytest.mark.parametrize("option", ["--out", "--resume"])
def test_a_directory_that_ros_cannot_be_told(tmp_path, capsys, option: str) -> None:
    error = refused(capsys, option, str(tmp_path / "caf\udce9"))
    assert error.startswith("error: expected a text in UTF-8, got '/")
    assert not any(tmp_path.iterdir())


def test_a_host_that_ros_cannot_be_told(tmp_path, capsys) -> None:
    error = refused(capsys, "--live", "caf\udce9", "--out", str(tmp_path / "run"))
    assert error.startswith("error: expected a text in UTF-8, got 'caf")
    assert not any(tmp_path.iterdir())


def test_pictures_that_config_yaml_cannot_name(tmp_path, pictures, capsys) -> None:
    shutil.copytree(pictures, tmp_path / "caf\udce9")
    line = ["--stimuli", str(tmp_path / "caf\udce9"), "--out", str(tmp_path / "run")]
    error = refused(capsys, "--in-process", *line, "--set", "eye_plant.stimuli.size_px=64")
    assert error.startswith("error: expected a text in UTF-8, got '/")
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize("option", ["--out", "--stimuli", "--resume", "--branch"])
def test_a_name_that_is_too_long_is_one_error(tmp_path, capsys, option: str) -> None:
    out = [] if option in ("--out", "--resume") else ["--out", str(tmp_path / "run")]
    error = refused(capsys, option, str(tmp_path / ("x" * 300)), *out)
    assert error.startswith("error: ")
    assert not any(tmp_path.iterdir())


@pytest.mark.parametrize("is_there", [True, False])
def test_of_two_starts_at_the_same_moment_one_has_the_directory(
    tmp_path, pictures, capsys, monkeypatch, is_there
) -> None:
    """The second one starts while the first reads its pictures, which takes longest."""
    directory = tmp_path / "run"
    if is_there:
        directory.mkdir()
    settings = {"eye_plant.stimuli.size_px": 64}
    request = RunRequest(stimuli=str(pictures), overrides=settings)
    other = replace(request, seed=2)
    monkeypatch.setattr(
        run_command, "_prepare_stimuli", once(lambda: prepare_new(other, directory))
    )
    with pytest.raises(InputError, match="expected a new or empty directory, it is not empty"):
        prepare_new(request, directory)
    assert [path.name for path in directory.iterdir()] == ["config.yaml"]
    assert read_configuration(directory / "config.yaml")["task"]["seed"] == 2


def once(act: Callable[[], object]) -> Callable[[object], None]:
    """Return a function that acts when it is called first, whatever it is given."""
    acts = [act]

    def call(_: object) -> None:
        if acts:
            acts.pop()()

    return call


def test_a_run_that_another_process_makes_is_not_resumed(
    tmp_path, small_run, capsys, monkeypatch
) -> None:
    monkeypatch.setattr(hold, "_PATIENCE_S", 0.0)
    directory = shutil.copytree(small_run, tmp_path / "run")
    before = {path: path.read_bytes() for path in directory.rglob("*") if path.is_file()}
    with hold.hold(directory):
        for more in ([], ["--extend", "20"]):
            error = refused(capsys, "--in-process", "--resume", str(directory), *more)
            assert error == (
                f"error: {directory}: expected a run at rest, another process is making it"
            )
    assert before == {path: path.read_bytes() for path in directory.rglob("*") if path.is_file()}


@pytest.mark.parametrize(
    ("code", "expected", "said"),
    [
        (EXIT_INTERRUPTED, 130, "to continue: abv run --resume"),
        (EXIT_FAULT, 3, "once the cause is gone, to continue: abv run "),
        (EXIT_DIVERGED, 3, ""),
        (2, 2, ""),
    ],
)
def test_how_to_go_on_is_said_where_that_helps(tmp_path, capsys, code, expected, said) -> None:
    directory = tmp_path / "run #1"
    assert concluded(lambda: (directory, code), " --in-process") == expected
    error = capsys.readouterr().err
    assert error.startswith(said)
    assert ("--resume" in error) == bool(said)
    assert not said or error.endswith(f"--resume '{directory}' --in-process\n")


def test_a_profile_that_is_meant() -> None:
    from experiment_manager import configuration_of

    with pytest.raises(
        InputError,
        match=r"^profile: expected a known name, got 'precice'; did you mean precise or ",
    ):
        configuration_of(RunRequest(profile="precice"), commit="")
