"""A help and a mistyped option need no second: what takes one is imported after them."""

import subprocess
import sys

import pytest

from tests.integration.test_scripts import ROOT, SCRIPTS

# Each takes a good part of a second, or more: numba compiles what it decorates.
HEAVY = {"cv2", "gymnasium", "matplotlib", "mcap", "mujoco", "numba", "rclpy", "scipy"}
CALL = "run_module "
MODULES = {
    name: path.read_text().rpartition(CALL)[2].split()[0]
    for name, path in SCRIPTS.items()
    if CALL in path.read_text()
}
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
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.mark.parametrize(("name", "module"), MODULES.items())
def test_a_help_waits_for_nothing(name: str, module: str) -> None:
    done = _started(module, "--help")
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(f"usage: {name}.sh [-h]")
    assert done.stdout.count("usage: ") == 1
    assert HEAVY.isdisjoint(done.stderr.split())


@pytest.mark.parametrize(("name", "module"), MODULES.items())
def test_nor_does_a_mistyped_option(name: str, module: str) -> None:
    needs_name = ("evaluate", "export_model", "inspect_bag", "report", "sweep")
    done = _started(module, *(["name"] if name in needs_name else []), "--hlep")
    assert done.returncode == 2
    error, modules = done.stderr.splitlines()
    wrong = f"{name}.sh: error: unrecognized arguments: --hlep; did you mean --help"
    assert error.startswith(wrong)
    assert HEAVY.isdisjoint(modules.split())


def test_names_of_a_package_are_imported_when_they_are_asked_for() -> None:
    line = "import sys, eye_plant; print({'numba', 'mujoco'} & {*sys.modules}); eye_plant.EyePlant"
    done = subprocess.run([sys.executable, "-c", line], capture_output=True, text=True, check=True)
    assert done.stdout == "set()\n"
    line = "import eye_plant; eye_plant.EyePlnat"
    done = subprocess.run([sys.executable, "-c", line], capture_output=True, text=True, check=False)
    assert "AttributeError: module 'eye_plant' has no attribute 'EyePlnat'" in done.stderr
