"""How a process ends whose node cannot be made."""

from collections.abc import Callable

import pytest
import rclpy
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node

from lockstep.exit_codes import EXIT_BAD_INPUT
from lockstep.node.process import run_node


def failing(message: str) -> Callable[[], Node]:
    def make_node() -> Node:
        raise rclpy_implementation.RCLError(message)

    return make_node


def test_what_ros_refuses_is_bad_input_in_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    message = "error creating node: failed to create domain,\n at node.c:252"
    assert run_node(failing(message), []) == EXIT_BAD_INPUT
    assert capsys.readouterr().err == (
        "error: error creating node: failed to create domain, at node.c:252\n"
    )
    assert not rclpy.ok()


@pytest.mark.parametrize("shortage", ["Resource temporarily unavailable", "Cannot allocate memory"])
def test_a_shortage_is_a_fault_and_no_bad_input(
    shortage: str, capsys: pytest.CaptureFixture[str]
) -> None:
    message = f"error creating node: Failed to create std::thread: {shortage}"
    with pytest.raises(rclpy_implementation.RCLError, match=shortage):
        run_node(failing(message), [])
    assert "error: " not in capsys.readouterr().err
    assert not rclpy.ok()
