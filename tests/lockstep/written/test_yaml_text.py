"""YAML that means the same to us, to PyYAML and to ROS; and what people may not write."""

import math
from pathlib import Path
from typing import Any

import pytest
import yaml
from rclpy.context import Context
from rclpy.node import Node

from experiment_manager.supervision.domains import own_domain
from lockstep import InputError
from lockstep.node.parameter_files import parameter_arguments
from lockstep.written.yaml_text import dump_yaml, load_yaml, yaml_line

# What some reader of YAML takes for a number, a truth, nothing, a comment, a mapping, a date, ...
TEXTS = (
    *("2024", "1e5", "-1e5", "0x10", "010", "1_000", ".5", "12:30:00", "2024-01-01", "0x1p3"),
    *("nan", "NaN(1)", "INF", "infinity", ".inf", "true", "y", "N", "off", "null", "~", ""),
    *("/data/run #1", "/a: b", "/run:", "/end ", " /start", "/a\nb", "/a\tb", "/a\\b", "it's"),
    *("{a,b}[1]", "*a", "&a", "!!x", "%YAML", "- a", "-", "<<", "=", "'quoted'", '"quoted"'),
    *("é😀", "\x7f", "\x85", "\u2028", "\ufeff", "x" * 300 + " y"),
)
VALUES: tuple[Any, ...] = (True, False, 5, -(2**63), 30.0, 1e-7, 1e300)


def as_ros_reads(arguments: list[str]) -> dict[str, Any]:
    with own_domain() as domain:
        context = Context()
        context.init(args=["--ros-args", *arguments], domain_id=domain)
        node = Node("n", context=context, enable_rosout=False, start_parameter_services=False)
        read = {name: parameter.value for name, parameter in node._parameter_overrides.items()}
        node.destroy_node()
        context.shutdown()
    return read


def test_ros_is_told_each_value_as_it_is(tmp_path: Path) -> None:
    told = {f"p{i}": value for i, value in enumerate((*TEXTS, *VALUES))}
    assert as_ros_reads(parameter_arguments(told)) == told
    file = tmp_path / "run #1: a"
    lists = {"texts": list(TEXTS), "numbers": [1.0, 1e-7]}
    file.write_text(dump_yaml({"/**": {"ros__parameters": told | lists}}))
    assert as_ros_reads(["--params-file", str(file)]) == told | lists


@pytest.mark.parametrize("value", [*TEXTS, *VALUES, math.inf, [*TEXTS], {"a": "1e5"}])
def test_all_readers_read_what_was_written(value: Any) -> None:
    for text in (dump_yaml([value]), f"[{yaml_line(value)}]"):
        assert load_yaml(text) == yaml.safe_load(text) == [value]
    assert "\n" not in yaml_line(value)


@pytest.mark.parametrize("write", [dump_yaml, yaml_line])
def test_a_text_that_no_yaml_has(write) -> None:
    with pytest.raises(InputError, match=r"expected a text in UTF-8, got '/data/caf\\udce9'"):
        write("/data/caf\udce9")
