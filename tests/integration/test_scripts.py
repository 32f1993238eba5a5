"""launch_scripts: what they start, and with which variables."""

import importlib.util
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from active_binocular_vision.command_lines import nodes
from active_binocular_vision.command_lines.abv import COMMANDS
from tests.patience import PATIENCE_S

ROOT = Path(__file__).parents[2]
SCRIPTS = {p.stem: p for p in sorted((ROOT / "launch_scripts").glob("*.sh"))}
del SCRIPTS["environment"]  # what they share
CALLS = ("abv", "start")
# Shows what a function of environment.sh would become, and its variables.
SHOW = r"""
source launch_scripts/environment.sh
exec() { printf '%s\0' "$@"; env -0; }
"$@"
"""


def finished(
    *words: str | Path, cwd: Path = ROOT, code: int = 0, user: int | None = None, **variables: str
) -> subprocess.CompletedProcess[str]:
    """Return what words did in an environment of few variables, and these."""
    environment = {name: os.environ[name] for name in ("PATH", "HOME") if name in os.environ}
    done = subprocess.run(
        words,
        cwd=cwd,
        env=environment | {"ABV_PYTHON": sys.executable} | variables,
        user=user,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        encoding="utf-8",
        check=False,
        timeout=PATIENCE_S,
    )
    assert done.returncode == code, done.stdout + done.stderr
    return done


def _started(*words: str, **variables: Any) -> tuple[list[str], dict[str, str]]:
    """Return the words after Python's, and the variables, of what a function would start."""
    python, *told = finished("bash", "-euc", SHOW, "show", *words, **variables).stdout.split("\0")
    assert python == f"{ROOT}/.venv/bin/python"
    n_words = len(words)  # -m stands for the function's name
    return told[:n_words], dict(v.split("=", 1) for v in told[n_words:] if v)


def test_help_needs_no_set_up(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "launch_scripts", tmp_path / "launch_scripts")
    for name in SCRIPTS:
        shown = finished(tmp_path / "launch_scripts" / f"{name}.sh", "--help", cwd=Path("/")).stdout
        assert f"usage: launch_scripts/{name}.sh" in shown
        assert "set -euo" not in shown
    assert not (tmp_path / ".venv").exists()


def test_every_script_starts_something_that_exists() -> None:
    call = re.compile(r'^(abv|start) ([\w.-]+) "\$@"$', re.MULTILINE)
    started = {name: call.findall(path.read_text()) for name, path in SCRIPTS.items()}
    assert [name for name, found in started.items() if not found] == [
        "abv",
        "docs",
        "setup",
        "test",
    ]
    words = {how: {w for found in started.values() for h, w in found if h == how} for how in CALLS}
    assert COMMANDS.keys() - words["abv"] == {"docs", "trained"}  # docs.sh sets more up
    assert [name for name in words["start"] if importlib.util.find_spec(name) is None] == []
    for function, _ in COMMANDS.values():
        module, _, name = function.partition(":")
        assert callable(getattr(importlib.import_module(module), name))


def test_words_reach_the_entry_point_as_they_are() -> None:
    assert _started("start", "tools.stress", "3 4")[0] == ["-m", "tools.stress", "3 4"]
    words = [
        *finished("bash", "-euc", SHOW, "show", "abv", "plant", "-p", "a b").stdout.split("\0")
    ]
    assert words[1:6] == ["-m", "active_binocular_vision", "plant", "-p", "a b"]
    shown = finished(SCRIPTS["list_parameters"], "--help").stdout
    assert shown.startswith("usage: launch_scripts/abv.sh parameters [-h]")
    assert shown.count("usage: ") == 1


def test_nodes_started_one_by_one_meet_in_one_domain(monkeypatch: pytest.MonkeyPatch) -> None:
    met = []
    node = ModuleType("eye_plant.node")
    node.main = lambda: met.append(os.environ["ROS_DOMAIN_ID"])  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "eye_plant.node", node)
    monkeypatch.setattr(sys, "argv", ["abv plant"])
    for domain in ("", "7"):
        monkeypatch.setenv("ROS_DOMAIN_ID", domain)
        with pytest.raises(SystemExit):
            nodes.plant()
    assert met == ["42", "7"]


def test_another_ros_installation_stays_out() -> None:
    _, variables = _started(
        "start",
        "x",
        PYTHONPATH="/opt/ros/jazzy/lib/python3.12/site-packages",
        AMENT_PREFIX_PATH="/opt/ros/jazzy",
        LD_LIBRARY_PATH="/opt/ros/jazzy/lib:/usr/lib/driver:/elsewhere/ros_rcl.libs",
        RMW_IMPLEMENTATION="rmw_cyclonedds_cpp",
    )
    assert not {"PYTHONPATH", "AMENT_PREFIX_PATH"} & variables.keys()
    assert variables["LD_LIBRARY_PATH"] == "/usr/lib/driver"
    assert variables["RMW_IMPLEMENTATION"] == "rmw_fastrtps_cpp"


def test_defaults_of_the_environment_yield_to_the_user() -> None:
    _, variables = _started("start", "x")
    assert variables["OPENBLAS_NUM_THREADS"] == "1"
    assert variables["MUJOCO_GL"] == "disable"
    assert Path(variables["FASTRTPS_DEFAULT_PROFILES_FILE"]).is_relative_to(ROOT / "src")
    theirs = {
        "FASTRTPS_DEFAULT_PROFILES_FILE": "/my/own.xml",
        "OPENBLAS_NUM_THREADS": "2",
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET",
    }
    assert theirs.items() <= _started("start", "x", **theirs)[1].items()


def test_what_pip_is_told_of_sources_stays() -> None:
    said = """global.index-url='https://here/it\\'s'
global.only-binary=':all:'
install.extra-index-url='https://a\\nhttps://b'
download.index-url='https://elsewhere'
install.proxy='http://of-file'
:env:.proxy='http://of-variable'
:env:.target='/x'
"""
    shown = 'python -I -S "$variables" pip <<<"$0"'.replace("python", sys.executable)
    script = f'source launch_scripts/environment.sh; eval "$({shown})"; env -0'
    told = finished("bash", "-euc", script, said, PIP_TARGET="/x", PIP_PROXY="y").stdout.split("\0")
    assert {line for line in told if line.startswith("PIP_")} == {
        "PIP_CONFIG_FILE=/dev/null",
        "PIP_INDEX_URL=https://here/it's",
        "PIP_EXTRA_INDEX_URL=https://a\nhttps://b",
        "PIP_PROXY=http://of-variable",
    }
