"""Which packages and modules may import what (CONTRIBUTING.md, "Where things are")."""

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.imported_names import imported_names

SRC = Path(__file__).parents[2] / "src"
SCIENCE = ("eye_plant", "sparse_coder", "vergence_rl")
ROS = ("rclpy", "rosgraph_msgs", "rcl_interfaces", "builtin_interfaces")


def modules() -> Iterator[Path]:
    for package in ("lockstep", *SCIENCE, "experiment_manager", "active_binocular_vision"):
        yield from (SRC / package / package).rglob("*.py")


def uses_ros(module: Path) -> bool:
    return any(name in ROS or name.endswith("_msgs") for name in imported_names(module))


def may_use_ros(module: Path) -> bool:
    in_package = module.relative_to(SRC).parts[1:]
    is_shared = in_package[0] == "lockstep" and in_package[1] == "wire"
    is_node = "node" in (*in_package[1:-1], module.stem) or module.stem.startswith("node_")
    return is_shared or is_node or module.stem == "messages"


def test_ros_is_imported_only_where_the_name_says_so() -> None:
    users = [module for module in modules() if uses_ros(module)]
    assert len(users) > len(SCIENCE)
    assert [str(module) for module in users if not may_use_ros(module)] == []


def test_importing_a_package_imports_no_ros() -> None:
    line = "import sys, eye_plant, lockstep, sparse_coder, vergence_rl; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", line], capture_output=True, text=True, check=True)
    assert set(done.stdout.split()).isdisjoint(ROS)


@pytest.mark.parametrize("package", SCIENCE)
def test_a_package_of_science_imports_no_other(package: str) -> None:
    others = {*SCIENCE, "experiment_manager", "active_binocular_vision"} - {package}
    found = {str(m): imported_names(m) & others for m in (SRC / package / package).rglob("*.py")}
    assert found
    assert {module: names for module, names in found.items() if names} == {}
