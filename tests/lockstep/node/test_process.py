"""How a process ends whose node cannot be made: by the phase in which it fails, not by the text."""

import re
from collections.abc import Callable

import pytest
import rclpy
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node

from lockstep import InputError
from lockstep.exit_codes import EXIT_BAD_INPUT
from lockstep.node.process import run_node

FAULTS = (
    "error creating node: failed to create domain,\n at node.c:252",
    "error creating node: Failed to create std::thread: Resource temporarily unavailable",
    "failed to create service: Failed to register type for service, at service.c:198",
    "Failed to create subscription: invalid allocator",
)


def failing(error: Exception) -> Callable[[], Node]:
    def make_node() -> Node:
        raise error

    return make_node


def test_a_refused_parameter_is_bad_input_in_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    error = InputError("n_bases: expected 1 or more,\n got 0")
    assert run_node(failing(error), []) == EXIT_BAD_INPUT
    assert capsys.readouterr().err == "error: n_bases: expected 1 or more, got 0\n"
    assert not rclpy.ok()


@pytest.mark.parametrize("name", ["1st", "a b", ""])
def test_a_name_that_ros_refuses_is_bad_input(name, capsys) -> None:
    assert run_node(lambda: Node(name), []) == EXIT_BAD_INPUT
    assert capsys.readouterr().err.startswith("error: Invalid node name: ")
    assert not rclpy.ok()


def test_a_parameter_of_a_wrong_type_is_bad_input(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["--ros-args", "-p", "use_sim_time:=5"]
    assert run_node(lambda: Node("somebody"), arguments) == EXIT_BAD_INPUT
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("error: Trying to set parameter 'use_sim_time' to '5'")


@pytest.mark.parametrize(
    ("arguments", "error"),
    [
        (["--ros-args", "--params-file", "/nowhere.yaml"], "expected ROS arguments: .*/nowhere"),
        (["--ros-args", "-r", "__node:=not-a-name"], "expected ROS arguments: .*not-a-name"),
        (["--ros-args", "--no-such-flag"], "expected ROS arguments: .*--no-such-flag"),
        (["--speed"], "unknown argument --speed: expected --ros-args"),
    ],
)
def test_arguments_that_cannot_be_read_are_bad_input(arguments, error, capsys) -> None:
    assert run_node(pytest.fail, arguments) == EXIT_BAD_INPUT
    (line,) = [line for line in capsys.readouterr().err.splitlines() if line.startswith("error: ")]
    assert re.match(f"error: {error}", line)


def test_a_domain_that_there_cannot_be_is_bad_input(monkeypatch, capsys) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", "233")
    assert run_node(pytest.fail, []) == EXIT_BAD_INPUT
    expected = "error: ROS_DOMAIN_ID: expected a whole number 0 to 232, got '233'\n"
    assert capsys.readouterr().err == expected


@pytest.mark.parametrize("message", FAULTS)
def test_what_fails_while_the_node_is_made_is_a_fault(message, capsys) -> None:
    with pytest.raises(rclpy_implementation.RCLError) as raised:
        run_node(failing(rclpy_implementation.RCLError(message)), [])
    assert str(raised.value) == message
    assert "error: " not in capsys.readouterr().err
    assert not rclpy.ok()


def test_what_fails_in_rclpy_init_is_a_fault(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_SECURITY_ENABLE", "true")
    monkeypatch.setenv("ROS_SECURITY_STRATEGY", "Enforce")
    monkeypatch.setenv("ROS_SECURITY_KEYSTORE", "/")
    with pytest.raises(rclpy_implementation.RCLError, match="initialize rcl"):
        run_node(pytest.fail, [])
    assert not rclpy.ok()
