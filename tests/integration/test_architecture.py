"""Which modules may import what (CONTRIBUTING.md, "Where things are"), and how long tests wait."""

import ast
import subprocess
import sys
from collections.abc import Callable, Iterator
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

from tests.imported_names import imported_names
from tests.patience import PATIENCE_S

SRC = Path(__file__).parents[2] / "src"
TESTS = Path(__file__).parents[1]
SCIENCE = ("eye_plant", "sparse_coder", "vergence_rl")
# The arrows of the packages: each may import these others.
MAY_IMPORT: dict[str, tuple[str, ...]] = {
    "lockstep": (),
    "eye_plant": ("lockstep",),
    "sparse_coder": ("lockstep",),
    "vergence_rl": ("lockstep",),
    "experiment_manager": ("lockstep", *SCIENCE),
    "active_binocular_vision": ("lockstep", *SCIENCE, "experiment_manager"),
}
ROS = ("rclpy", "rosgraph_msgs", "rcl_interfaces", "builtin_interfaces")


def modules() -> Iterator[Path]:
    for package in MAY_IMPORT:
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


def _is_of(name: str, call: ast.Call) -> bool:
    return ast.unparse(call.func).split(".")[-2].endswith(name)


def _has_timeout(call: ast.Call) -> bool:
    return "timeout" in {keyword.arg for keyword in call.keywords}


# Calls that may wait for ever, and whether a call of them has its end.
_WAITS: dict[str, Callable[[ast.Call], bool]] = {
    "run": lambda call: not _is_of("subprocess", call) or _has_timeout(call),
    "urlopen": _has_timeout,
    "communicate": _has_timeout,
    "join": lambda call: bool(call.args),
    "wait": lambda call: bool(call.args) or not _is_of("process", call),
}


def test_no_test_can_wait_for_ever() -> None:
    calls = [
        (path, node.func.attr, node)
        for path in TESTS.rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute)
    ]
    found = [f"{p}:{c.lineno}" for p, name, c in calls if not _WAITS.get(name, bool)(c)]
    assert found == []
    assert {name for _, name, _ in calls} >= _WAITS.keys()


def test_importing_a_package_imports_no_ros() -> None:
    line = "import sys, eye_plant, lockstep, sparse_coder, vergence_rl; print(*sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", line], capture_output=True, text=True, check=True, timeout=PATIENCE_S
    )
    assert set(done.stdout.split()).isdisjoint(ROS)


@pytest.mark.parametrize("package", [*MAY_IMPORT])
def test_packages_import_downwards(package: str) -> None:
    others = set(MAY_IMPORT) - {package, *MAY_IMPORT[package]}
    found = {str(m): imported_names(m) & others for m in (SRC / package / package).rglob("*.py")}
    assert found
    assert {module: names for module, names in found.items() if names} == {}


def _folder(name: str) -> str | None:
    """Return the folder of an imported name; a module at a package's root is one of its own."""
    path = SRC.joinpath(name.partition(".")[0], *name.split("."))
    while not (path.is_dir() or path.with_suffix(".py").is_file()):
        path = path.parent
    parts = path.relative_to(SRC).parts[1:]
    if not parts or path.is_dir():
        return ".".join(parts) or None
    return ".".join(parts if len(parts) == 2 else parts[:-1])


def test_folders_import_without_a_circle() -> None:
    graph: dict[str, set[str]] = {}
    for module in modules():
        here = _folder(".".join(module.relative_to(SRC).with_suffix("").parts[1:]))
        for node in ast.walk(ast.parse(module.read_text())):
            if not isinstance(node, ast.ImportFrom) or not node.module:
                continue
            if node.module.partition(".")[0] not in MAY_IMPORT:
                continue
            names = [f"{node.module}.{alias.name}" for alias in node.names]
            if here:
                graph.setdefault(here, set()).update(
                    there for name in names if (there := _folder(name)) and there != here
                )
    list(TopologicalSorter(graph).static_order())  # raises CycleError with the folders
