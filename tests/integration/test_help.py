"""A help and a mistyped option need no second: what takes one is imported after them."""

import subprocess
import sys

import pytest

from active_binocular_vision.command_lines.abv import COMMANDS
from experiment_manager.preparation.profile_paths import profile_files
from tests.integration.test_scripts import ROOT
from tests.patience import PATIENCE_S

# Each takes a good part of a second, or more: numba compiles what it decorates.
HEAVY = {"cv2", "gymnasium", "matplotlib", "mcap", "mujoco", "numba", "rclpy", "scipy"}
TOOLS = {"benchmark.sh": "tools.benchmark", "torture.sh": "tools.stress"}
# Nodes take the arguments of ROS, which ROS itself reads.
OWN = [name for name, (function, _) in COMMANDS.items() if "nodes:" not in function]
NEED_NAME = {"baselines", "evaluate", "examine", "bag", "report", "sweep"}
START = """
import runpy, sys
root, module, *sys.argv[1:] = sys.argv[1:]
sys.path.insert(0, root)
try:
    runpy.run_module(module, run_name="__main__", alter_sys=True)
finally:
    print(*sys.modules, file=sys.stderr)
"""


def _started(module: str, *words: str) -> "subprocess.CompletedProcess[str]":
    command = [sys.executable, "-c", START, str(ROOT), module, *words]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=PATIENCE_S)


def _of_abv(*words: str) -> "subprocess.CompletedProcess[str]":
    return _started("active_binocular_vision", *words)


@pytest.mark.parametrize("name", COMMANDS)
def test_a_help_waits_for_nothing(name: str) -> None:
    _check_help(_of_abv(name, "--help"), f"abv {name}")


@pytest.mark.parametrize(("name", "module"), TOOLS.items())
def test_nor_does_that_of_a_tool(name: str, module: str) -> None:
    _check_help(_started(module, "--help"), name)


def _check_help(done: "subprocess.CompletedProcess[str]", name: str) -> None:
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(f"usage: {name} [-")
    assert done.stdout.count("usage: ") == 1
    assert HEAVY.isdisjoint(done.stderr.split())


@pytest.mark.parametrize("name", OWN)
def test_nor_does_a_mistyped_option(name: str) -> None:
    done = _of_abv(name, *(["name"] if name in NEED_NAME else []), "--hlep")
    assert done.returncode == 2
    error, modules = done.stderr.splitlines()
    wrong = f"abv {name}: error: unrecognized arguments: --hlep; did you mean --help"
    assert error.startswith(wrong)
    assert HEAVY.isdisjoint(modules.split())


def test_abv_lists_its_commands_and_suggests_the_nearest() -> None:
    shown = _of_abv("--help").stdout
    assert all(f"  {name} " in shown for name in COMMANDS)
    assert _of_abv().stdout == shown
    done = _of_abv("examin")
    error, modules = done.stderr.splitlines()
    assert (done.returncode, HEAVY & {*modules.split()}) == (2, set())
    assert (
        error == "abv: error: command: expected a known name, got 'examin'; did you mean examine?"
    )


def test_the_help_of_a_run_names_every_profile() -> None:
    listed = _of_abv("run", "--help").stdout.partition("\nprofiles:\n")[2]
    assert set(profile_files()) <= set(listed.replace(",", " ").split())


def test_names_of_a_package_are_imported_when_they_are_asked_for() -> None:
    line = "import sys, eye_plant; print({'numba', 'mujoco'} & {*sys.modules}); eye_plant.EyePlant"
    done = subprocess.run(
        [sys.executable, "-c", line], capture_output=True, text=True, check=True, timeout=PATIENCE_S
    )
    assert done.stdout == "set()\n"
    line = "import eye_plant; eye_plant.EyePlnat"
    done = subprocess.run(
        [sys.executable, "-c", line],
        capture_output=True,
        text=True,
        check=False,
        timeout=PATIENCE_S,
    )
    assert "AttributeError: module 'eye_plant' has no attribute 'EyePlnat'" in done.stderr
