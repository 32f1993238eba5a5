"""launch_scripts, run with stand-ins for Python and the system's tools: nothing is installed."""

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from tests.patience import PATIENCE_S

ROOT = Path(__file__).parents[2]
SCRIPTS = tuple(
    sorted(p.stem for p in (ROOT / "launch_scripts").glob("*.sh") if p.stem != "environment")
)
NODES = ("eye_plant", "sparse_coder", "vergence_rl", "experiment_manager")
NOBODY = 65534
MODULES = {
    "run_experiment": "active_binocular_vision.commands.run_experiment",
    "sweep": "active_binocular_vision.commands.sweep",
    "evaluate": "active_binocular_vision.commands.evaluate",
    "report": "active_binocular_vision.commands.report",
    "list_parameters": "active_binocular_vision.commands.list_parameters",
    "inspect_bag": "active_binocular_vision.commands.inspect_bag",
    "benchmark": "tools.benchmark",
    "torture": "tools.stress",
    "validate_plant": "eye_plant.validation",
}

# Does what the scripts ask of a Python, without one, and notes each call in $CALLS.
_PYTHON = """#!/bin/bash
echo "python $1 $2 $3" | head -n 1 >>"$CALLS"
case "$1 $2" in
  "-I -S")
    [[ $3 != *.py ]] || exec {python} "$@"
    echo "3.11.0 (stand-in)"
    ;;
  "-I -c") exit "${PYTHON_FITS:-0}" ;;
  "-I -m")
    mkdir -p "$5/bin" "$5/lib/python3.11/site-packages"
    cp "$0" "$5/bin/python"
    ;;
  "-m pip") exit "${PIP:-0}" ;;
  "-m ruff") exit "${RUFF:-0}" ;;
  "-m mypy") exit "${MYPY:-0}" ;;
  "-m pytest")
    echo "$*"
    echo "pytest's closing line"
    exit "${PYTEST:-0}"
    ;;
  "-c "*) ;;
  *)
    printf '%s\\n' "$@"
    env
    ;;
esac
"""
_APT_GET = """#!/bin/bash
echo "apt-get $1" >>"$CALLS"
"""
_ID = """#!/bin/bash
echo "${USER_ID:-1000}"
"""


class Checkout:
    """A copy of the scripts in a folder of its own, with stand-ins first on the path."""

    def __init__(self, folder: Path) -> None:
        folder.mkdir(exist_ok=True)
        self.root = folder / "checkout"
        self.calls_file = folder / "calls"
        self.user: int | None = None  # who starts the scripts: whoever runs the tests
        self._stand_ins = folder / "bin"
        shutil.copytree(ROOT / "launch_scripts", self.root / "launch_scripts")
        shutil.copy(ROOT / "requirements.lock", self.root)
        variables = "src/lockstep/lockstep/machine/environment.py"
        (self.root / variables).parent.mkdir(parents=True)
        shutil.copy(ROOT / variables, self.root / variables)
        self._stand_ins.mkdir()
        for name, text in (
            ("python3", _PYTHON.replace("{python}", sys.executable)),
            ("apt-get", _APT_GET),
            ("id", _ID),
        ):
            (self._stand_ins / name).write_text(text)
            (self._stand_ins / name).chmod(0o755)
        self.environment = {
            "PATH": f"{self._stand_ins}:/usr/bin:/bin",
            "HOME": str(folder),
            "CALLS": str(self.calls_file),
            "ABV_PYTHON": str(self._stand_ins / "python3"),
        }

    def start(
        self, script: str, *arguments: str, **environment: str
    ) -> subprocess.CompletedProcess[str]:
        self.calls_file.write_text("")
        return subprocess.run(
            [self.root / "launch_scripts" / f"{script}.sh", *arguments],
            env={**self.environment, **environment},
            cwd="/",
            user=self.user,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            check=False,
            timeout=PATIENCE_S,
        )

    def calls(self) -> list[str]:
        return self.calls_file.read_text().splitlines()


@pytest.fixture
def checkout(tmp_path: Path) -> Checkout:
    return Checkout(tmp_path)


@pytest.fixture(scope="module")
def ready(tmp_path_factory: pytest.TempPathFactory) -> Checkout:
    """Return a checkout that is set up; not to change."""
    checkout = Checkout(tmp_path_factory.mktemp("ready"))
    assert checkout.start("setup").returncode == 0
    return checkout


def _variables(output: str) -> dict[str, str]:
    return dict(line.split("=", 1) for line in output.splitlines() if "=" in line)


@pytest.mark.parametrize("script", SCRIPTS)
def test_help_needs_no_set_up(checkout: Checkout, script: str) -> None:
    assert os.access(ROOT / f"launch_scripts/{script}.sh", os.X_OK)
    shown = checkout.start(script, "--help")
    assert shown.returncode == 0, shown.stderr
    assert f"usage: launch_scripts/{script}.sh" in shown.stdout
    assert "set -euo" not in shown.stdout
    assert not any("pip" in call for call in checkout.calls())


@pytest.mark.parametrize(("script", "module"), MODULES.items())
def test_a_script_starts_its_entry_point_and_shows_its_help(
    ready: Checkout, script: str, module: str
) -> None:
    started = ready.start(script, "--seed", "3 4")
    assert started.stdout.splitlines()[:4] == ["-m", module, "--seed", "3 4"]
    shown = ready.start(script, "--help").stdout
    assert shown.index(f"usage: launch_scripts/{script}.sh") < shown.index(f"{module}\n")


@pytest.mark.parametrize("node", NODES)
def test_a_node_gets_the_parameters_of_the_user(ready: Checkout, node: str) -> None:
    started = ready.start(node, "--ros-args", "-p", "seed:=2")
    expected = ["-m", f"{node}.node", "--ros-args", "-p", "seed:=2"]
    assert started.stdout.splitlines()[:5] == expected


def test_nodes_started_one_by_one_meet_in_one_domain(ready: Checkout) -> None:
    assert {_variables(ready.start(n).stdout)["ROS_DOMAIN_ID"] for n in NODES} == {"42"}
    started = ready.start("eye_plant", ROS_DOMAIN_ID="7")
    assert _variables(started.stdout)["ROS_DOMAIN_ID"] == "7"
    assert "ROS_DOMAIN_ID" not in _variables(ready.start("run_experiment").stdout)


def test_another_ros_installation_stays_out(ready: Checkout) -> None:
    started = ready.start(
        "eye_plant",
        PYTHONPATH="/opt/ros/jazzy/lib/python3.12/site-packages",
        AMENT_PREFIX_PATH="/opt/ros/jazzy",
        LD_LIBRARY_PATH="/opt/ros/jazzy/lib:/usr/lib/driver:/elsewhere/ros_rcl.libs",
        RMW_IMPLEMENTATION="rmw_cyclonedds_cpp",
    )
    variables = _variables(started.stdout)
    assert "PYTHONPATH" not in variables
    assert "AMENT_PREFIX_PATH" not in variables
    assert variables["LD_LIBRARY_PATH"] == "/usr/lib/driver"
    assert variables["RMW_IMPLEMENTATION"] == "rmw_fastrtps_cpp"


def test_defaults_of_the_environment_yield_to_the_user(ready: Checkout) -> None:
    variables = _variables(ready.start("eye_plant").stdout)
    assert variables["OPENBLAS_NUM_THREADS"] == "1"
    assert variables["MUJOCO_GL"] == "disable"
    profiles = Path("src/lockstep/config/this_machine.xml")
    assert variables["FASTRTPS_DEFAULT_PROFILES_FILE"] == str(ready.root / profiles)
    assert (ROOT / profiles).is_file()
    theirs = {
        "FASTRTPS_DEFAULT_PROFILES_FILE": "/my/own.xml",
        "OPENBLAS_NUM_THREADS": "2",
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET",
        "MUJOCO_GL": "osmesa",
    }
    assert theirs.items() <= _variables(ready.start("eye_plant", **theirs).stdout).items()


def test_second_start_has_nothing_to_set_up(ready: Checkout) -> None:
    assert ready.start("setup").stderr == ""
    assert set(ready.calls()) <= {"python -I -S -c"}


def test_set_up_happens_by_itself_at_the_first_start(checkout: Checkout) -> None:
    started = checkout.start("eye_plant")
    assert started.returncode == 0, started.stderr
    assert "python -I -m venv" in checkout.calls()
    assert "eye_plant.node" in started.stdout.splitlines()


def test_changed_lock_file_is_installed(checkout: Checkout) -> None:
    assert checkout.start("setup").returncode == 0
    with (checkout.root / "requirements.lock").open("a") as lock:
        lock.write("another==1.0\n")
    checkout.start("setup")
    assert "python -m pip install" in checkout.calls()


def test_interrupted_set_up_is_made_again(checkout: Checkout) -> None:
    broken = checkout.start("eye_plant", PIP="1")
    assert broken.returncode == 1
    assert broken.stdout == ""
    assert broken.stderr.splitlines()[-1].startswith("setup: pip could not install")
    assert checkout.start("eye_plant").returncode == 0
    assert "python -I -m venv" in checkout.calls()


def test_two_at_once_set_up_once(checkout: Checkout) -> None:
    command = [checkout.root / "launch_scripts" / "setup.sh"]
    checkout.calls_file.write_text("")
    both = [subprocess.Popen(command, env=checkout.environment) for _ in range(2)]
    assert [process.wait(60) for process in both] == [0, 0]
    assert checkout.calls().count("python -I -m venv") == 1


def test_a_path_with_an_umlaut_in_the_locale_c(tmp_path: Path) -> None:
    checkout = Checkout(tmp_path / "Prüfstand")
    packages = [checkout.root / "src" / name for name in ("lockstep", *NODES)]
    for package in packages:
        package.mkdir(parents=True, exist_ok=True)
    assert checkout.start("setup", LC_ALL="C").returncode == 0
    (folder,) = checkout.root.glob(".venv/lib/python3*/site-packages")
    look = "import os, site, sys; site.addsitedir(sys.argv[1]); print(*map(os.fsencode, sys.path))"
    found = subprocess.run(
        [sys.executable, "-I", "-S", "-c", look, folder],
        env={"LC_ALL": "C"},
        capture_output=True,
        text=True,
        check=True,
    )
    for package in packages:
        assert str(os.fsencode(package)) in found.stdout.split()
    assert _variables(checkout.start("eye_plant", LC_ALL="C").stdout)["PYTHONUTF8"] == "1"


@pytest.mark.skipif(os.getuid() != 0, reason="needs root, to be two users")
def test_an_environment_of_another_user_is_named_as_such() -> None:
    with tempfile.TemporaryDirectory() as shared:
        Path(shared).chmod(0o755)
        checkout = Checkout(Path(shared))
        assert checkout.start("setup").returncode == 0
        (checkout.root / ".venv" / "bin" / "python").chmod(0o700)
        checkout.calls_file.chmod(0o666)
        checkout.user = NOBODY
        for arguments in ([], ["--again"]):
            refused = checkout.start("setup", *arguments)
            assert refused.returncode == 1
            (line,) = refused.stderr.splitlines()
            assert line.startswith(f"setup: {checkout.root}/.venv belongs to the user root, and ")
            assert f"git clone {checkout.root}" in line


def test_a_missing_python_is_said_in_one_sentence(checkout: Checkout) -> None:
    stopped = checkout.start("run_experiment", PYTHON_FITS="1")
    assert stopped.returncode == 1
    sentence = "is not a Python 3.11 to 3.14 with its venv module."
    assert sentence in stopped.stderr.splitlines()[-1]
    assert not any(call.startswith("apt-get") for call in checkout.calls())


@pytest.mark.parametrize(
    ("environment", "status"),
    [
        ({}, 0),
        ({"RUFF": "1"}, 1),
        ({"MYPY": "2"}, 1),
        ({"PYTEST": "2"}, 2),
        ({"PYTEST": "2", "RUFF": "1"}, 2),
    ],
)
def test_every_check_counts_and_pytest_has_the_last_word(ready, environment, status) -> None:
    assert os.access(ROOT / ".ci/run", os.X_OK)
    tested = ready.start("test", "-n", "0", "-x", **environment)
    assert tested.returncode == status
    *_, call, last = tested.stdout.splitlines()
    assert last == "pytest's closing line"
    # Of two options of a name the last one holds.
    assert call.startswith("-m pytest -n logical ")
    assert call.endswith(" -n 0 -x")


@pytest.mark.parametrize("folder", ["plain", "with a blank"])
def test_changed_sources_have_a_numba_cache_of_their_own(tmp_path: Path, folder: str) -> None:
    (tmp_path / folder).mkdir()
    checkout = Checkout(tmp_path / folder)
    source = checkout.root / "src" / "coder.py"
    named = []
    for text in ("import numba", "import numba  # changed", "import numba"):
        source.write_text(text)
        script = "source launch_scripts/environment.sh; export_variables; echo $NUMBA_CACHE_DIR"
        done = subprocess.run(
            ["bash", "-euc", script],
            cwd=checkout.root,
            env=checkout.environment,
            capture_output=True,
            text=True,
            check=True,
        )
        assert not done.stderr
        named.append(done.stdout.strip())
    assert named[0] == named[2] != named[1]
    assert all(name.startswith(f"{checkout.root}/.venv/numba_cache/") for name in named)
