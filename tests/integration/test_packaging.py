"""The packages as a ROS workspace sees them: built by colcon, started from what it installed."""

import os
import re
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path
from typing import Any

import pytest

from active_binocular_vision.command_lines.abv import COMMANDS
from tests.imported_names import imported_names
from tests.patience import PATIENCE_S

ROOT = Path(__file__).parents[2]
NODES = ("eye_plant", "sparse_coder", "vergence_rl", "experiment_manager")
PACKAGES = ("lockstep", *NODES, "active_binocular_vision")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]


def _run(folder: Path, *words: str | Path, code: int = 0, **variables: str) -> str:
    """Run a command in a folder to its end with that exit code; return what it says."""
    done = subprocess.run(
        words,
        cwd=folder,
        env=os.environ | variables,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
        timeout=PATIENCE_S,
    )
    assert done.returncode == code, done.stdout
    return done.stdout


def _colcon(folder: Path, *words: str) -> str:
    colcon = Path(sys.executable).with_name("colcon")
    own: dict[str, Any] = {"COLCON_HOME": str(folder), "COLCON_DEFAULTS_FILE": os.devnull}
    return _run(folder, colcon, "--log-base", "log", *words, **own)


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build a copy of src; return the workspace with its folder install."""
    folder = tmp_path_factory.mktemp("workspace")
    ignore = shutil.ignore_patterns("__pycache__", "build", "install", "log")
    shutil.copytree(ROOT / "src", folder / "src", ignore=ignore)
    _colcon(folder, "build")
    return folder


def _site_packages(workspace: Path, package: str) -> Path:
    (folder,) = (workspace / "install" / package / "lib").glob("python*/site-packages")
    return folder


# In the place of numba's compiler, which would take half a minute: nothing is calculated here.
_UNCOMPILED = """
import numba

numba.njit = numba.vectorize = lambda *_, **__: lambda function: function
"""


def _run_installed(workspace: Path, *words: str | Path, code: int = 0) -> str:
    (workspace / "sitecustomize.py").write_text(_UNCOMPILED)
    paths = [workspace, *(_site_packages(workspace, package) for package in PACKAGES)]
    return _run(workspace, *words, code=code, PYTHONPATH=os.pathsep.join(map(str, paths)))


@pytest.mark.parametrize("package", PACKAGES)
def test_package_is_registered_and_installed_with_all_its_files(workspace, package) -> None:
    share = workspace / "install" / package / "share"
    assert (share / "ament_index/resource_index/packages" / package).is_file()
    source = ROOT / "src" / package
    shared = [source / name for name in ("package.xml", "README.md", "LICENSE")]
    shared += [*source.glob("config/*"), *source.glob("launch/*.launch.py")]
    installed = {file: share / package / file.relative_to(source) for file in shared}
    for file in (workspace / "src" / package / package).rglob("*"):
        if file.is_file() and file.suffix != ".TXT":  # MuJoCo's log, left by a crash
            below = file.relative_to(workspace / "src" / package)
            installed[file] = _site_packages(workspace, package) / below
    for file, copy in installed.items():
        assert copy.read_bytes() == file.read_bytes()
    assert f"<name>{package}</name>" in (source / "package.xml").read_text()
    assert (source / "README.md").read_text().startswith(f"# {package}\n")
    assert (source / "LICENSE").read_bytes() == (ROOT / "LICENSE").read_bytes()


def test_colcon_test_finds_the_tests_of_each_package(tmp_path: Path) -> None:
    # As a clone in a workspace: the tests are beside src. Only collected here, not run, and empty,
    # as what they import takes seconds.
    expected = []
    for package in PACKAGES:
        shutil.copytree(ROOT / "src" / package, tmp_path / "src" / package)
        built = tmp_path / "install" / package / "share" / package
        built.mkdir(parents=True)
        (built / "package.sh").touch()
        for file in (ROOT / "tests" / package).rglob("test_*.py"):
            empty = tmp_path / file.relative_to(ROOT)
            empty.parent.mkdir(parents=True, exist_ok=True)
            empty.write_text("def test_nothing(): pass\n")
            expected.append(file.name)
    collect = ["--event-handlers", "console_direct+", "--pytest-args", "-q", "--collect-only"]
    tested = _colcon(tmp_path, "test", "--base-paths", "src", *collect)
    assert sorted(re.findall(r"(test_\w+\.py)::", tested)) == sorted(expected), tested


_LOAD_ENTRY_POINTS = """
import sys
from importlib.metadata import distributions

folder = sys.argv[1]
(installed,) = distributions(path=[folder])
for entry in installed.entry_points:
    function = entry.load()
    assert callable(function), entry
    assert function.__code__.co_filename.startswith(folder), function.__code__.co_filename
    print("entry point:", entry.module)
"""


@pytest.mark.parametrize("package", [*NODES, "active_binocular_vision"])
def test_entry_points_lead_into_what_was_installed(workspace: Path, package: str) -> None:
    folder = _site_packages(workspace, package)
    loaded = _run_installed(workspace, sys.executable, "-c", _LOAD_ENTRY_POINTS, folder)
    sources = ROOT / "src" / package
    with_main = {
        ".".join(file.relative_to(sources).with_suffix("").parts)
        for file in (sources / package).rglob("*.py")
        # What these do is begun by command_lines.
        if "\ndef main(" in file.read_text() and file.parent.name != "commands"
    }
    of_abv = {function.partition(":")[0] for function, _ in COMMANDS.values()}
    assert set(re.findall("entry point: (.*)", loaded)) == with_main - of_abv


@pytest.mark.parametrize("package", NODES)
def test_installed_node_names_an_unknown_parameter(workspace: Path, package: str) -> None:
    # Where ros2 run looks for its executable.
    executable = workspace / "install" / package / "lib" / package / f"{package}_node"
    parameter = ["--ros-args", "-p", "no_such_parameter:=1"]
    said = _run_installed(workspace, executable, *parameter, code=2)
    assert "no_such_parameter" in said.splitlines()[-1]


_ROSDEP_KEYS = {
    "cv2": "python3-opencv",
    "matplotlib": "python3-matplotlib",
    "mcap": "python3-mcap-pip",
    "mujoco": "python3-mujoco-pip",
    "llvmlite": "python3-numba",  # which brings it
    "numba": "python3-numba",
    "numpy": "python3-numpy",
    "pandas": "python3-pandas",
    "PIL": "python3-pil",
    "psutil": "python3-psutil",
    "scipy": "python3-scipy",
    "tqdm": "python3-tqdm",
    "yaml": "python3-yaml",
}


@pytest.mark.parametrize("package", PACKAGES)
def test_manifest_names_what_the_package_imports(package: str) -> None:
    folder = ROOT / "src" / package
    every = (imported_names(module) for module in (folder / package).rglob("*.py"))
    imported = set().union(*every) - {package} - sys.stdlib_module_names
    manifest = (folder / "package.xml").read_text()
    comments = " ".join(re.findall("<!--(.*?)-->", manifest))
    named = set(re.findall("<exec_depend[^>]*>(.*?)</exec_depend>", manifest))
    named |= set(re.findall(r"\w+", comments))  # those from PyPI, which rosdep does not know
    assert {_ROSDEP_KEYS.get(name, name) for name in imported} <= named


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> zipfile.ZipFile:
    """Return the distribution that `pip install .` installs, built of the files that git has."""
    source, built = (tmp_path_factory.mktemp(name) for name in ("source", "built"))
    for name in ("README.md", "LICENSE", "pyproject.toml"):
        shutil.copy(ROOT / name, source)
    ignore = shutil.ignore_patterns("__pycache__", "build", "*.egg-info", "MUJOCO_LOG.TXT")
    shutil.copytree(ROOT / "src", source / "src", ignore=ignore)
    build = f"from setuptools.build_meta import build_wheel; build_wheel({str(built)!r})"
    _run(source, sys.executable, "-c", build)
    (path,) = built.glob("*.whl")
    return zipfile.ZipFile(path)


def test_one_distribution_has_every_file_of_the_six_packages(wheel: zipfile.ZipFile) -> None:
    folders = [ROOT / "src" / package for package in PACKAGES]
    files = {
        file.relative_to(folder).as_posix(): file
        for folder in folders
        for file in (folder / folder.name).rglob("*")
        if file.is_file() and "__pycache__" not in file.parts and file.suffix != ".TXT"
    }
    names = {name for name in wheel.namelist() if ".dist-info/" not in name}
    assert names == files.keys()
    assert "experiment_manager/profiles/clinic/healthy.yaml" in names
    for name, file in files.items():
        assert wheel.read(name) == file.read_bytes()


def test_it_installs_one_command(wheel: zipfile.ZipFile) -> None:
    (entry_points,) = (n for n in wheel.namelist() if n.endswith("/entry_points.txt"))
    abv = "abv = active_binocular_vision.command_lines.abv:main"
    assert wheel.read(entry_points).decode().split("\n")[:2] == ["[console_scripts]", abv]


def test_the_versions_are_one() -> None:
    version = PROJECT["version"]
    for package in PACKAGES:
        folder = ROOT / "src" / package
        assert f"<version>{version}</version>" in (folder / "package.xml").read_text()
        assert f'version="{version}"' in (folder / "setup.py").read_text()
    assert f"\nversion: {version}\n" in (ROOT / "CITATION.cff").read_text()


def _named(requirement: str) -> str:
    return re.split(r"[^\w-]", requirement)[0]


# What is imported by another name than that of its distribution.
_DISTRIBUTIONS = {
    "cv2": "opencv-python-headless",
    "llvmlite": "numba",  # which brings it
    "PIL": "pillow",
    "yaml": "pyyaml",
    "foxglove": "foxglove-sdk",
    "rclpy": "ros-jazzy-rclpy",
    "rcl_interfaces": "ros-jazzy-rclpy",
    "builtin_interfaces": "ros-jazzy-rclpy",
    "rosgraph_msgs": "ros-jazzy-rclpy",
    "sensor_msgs": "ros-jazzy-common-interfaces",
    "diagnostic_msgs": "ros-jazzy-common-interfaces",
}


def test_the_distribution_requires_what_its_packages_import() -> None:
    modules = (m for package in PACKAGES for m in (ROOT / "src" / package / package).rglob("*.py"))
    imported = set().union(*map(imported_names, modules)) - {*PACKAGES} - sys.stdlib_module_names
    required = {_named(requirement) for requirement in PROJECT["dependencies"]}
    of_extras = {
        _named(name) for extra in PROJECT["optional-dependencies"].values() for name in extra
    }
    imported = {_DISTRIBUTIONS.get(name, name) for name in imported}
    assert required <= imported
    assert imported <= required | of_extras
    assert "mujoco>=4" in PROJECT["dependencies"]


def test_the_lock_files_pin_what_is_required() -> None:
    locked = (ROOT / "requirements.lock").read_text()
    live = (ROOT / "requirements-live.lock").read_text()
    required = {_named(requirement) for requirement in PROJECT["dependencies"]}
    assert required <= set(re.findall("^([a-z][a-z0-9-]*)==", locked, re.MULTILINE))
    assert all(
        f"\n{_named(name)}==" in f"\n{live}" for name in PROJECT["optional-dependencies"]["live"]
    )
