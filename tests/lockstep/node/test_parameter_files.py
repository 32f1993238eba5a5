"""Parameter files that ROS would misread without a word."""

from pathlib import Path

import pytest

from lockstep.exit_codes import EXIT_BAD_INPUT
from lockstep.node.parameter_files import check_arguments
from lockstep.node.process import run_node


def _file(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "mine.yaml"
    path.write_text(text)
    return path


@pytest.mark.parametrize(
    ("parameters", "error"),
    [
        ("{seed: 1, seed: 2}", "line 2: expected each key once, got 'seed' twice"),
        ("{seed: 010}", "expected a number without leading zeros, got 010"),
        (
            "{camera.width_px: 320, camera: {width_px: 640}}",
            "/**: expected each name once, got 'ros__parameters.camera.width_px' twice",
        ),
    ],
)
def test_what_ros_would_misread_is_one_error(tmp_path, capsys, parameters, error) -> None:
    path = _file(tmp_path, f"/**:\n  ros__parameters: {parameters}\n")
    assert run_node(pytest.fail, ["--ros-args", "--params-file", str(path)]) == (EXIT_BAD_INPUT)
    assert capsys.readouterr().err == f"error: {path}: {error}\n"


def test_arguments_that_are_not_in_utf_8(capsys) -> None:
    assert run_node(pytest.fail, ["--ros-args", "-p", "a:=\udce9"]) == EXIT_BAD_INPUT
    assert "error: expected arguments in UTF-8, got 'a:=\\udce9'" in capsys.readouterr().err


def test_other_files_are_for_ros_to_read(tmp_path: Path) -> None:
    text = "/**:\n  ros__parameters:\n    a: {b: 1, c: 0x10}\nn:\n  ros__parameters: {a.b: 1}\n"
    check_arguments(["--ros-args", "--params-file", str(_file(tmp_path, text))])
    check_arguments(["--ros-args", "--params-file", str(tmp_path / "nowhere.yaml")])
