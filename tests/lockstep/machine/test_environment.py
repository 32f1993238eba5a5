"""The environment of nodes: what they ignore, what is set, and what none could work in."""

import os
import re
import socket
from pathlib import Path
from typing import Any

import pytest

from lockstep.machine import environment
from lockstep.machine.environment import adopt, changes, reaches_other_machines, why_refused

CONFIG = Path(environment.__file__).parent
RANGE, PROFILE = "ROS_AUTOMATIC_DISCOVERY_RANGE", "FASTRTPS_DEFAULT_PROFILES_FILE"
THIS_MACHINE = {RANGE: "SYSTEM_DEFAULT", PROFILE: str(CONFIG / "this_machine.xml")}
NETWORK = str(CONFIG / "network.xml")
SECURE = {"ROS_SECURITY_ENABLE": "true", "ROS_SECURITY_STRATEGY": "Enforce"}


@pytest.fixture(autouse=True)
def bare(monkeypatch: pytest.MonkeyPatch) -> None:
    """Leave the process without variables."""
    for name in os.environ:
        monkeypatch.delenv(name)


def _set(monkeypatch: pytest.MonkeyPatch, given: dict[str, str]) -> None:
    for name, value in given.items():
        monkeypatch.setenv(name, value)


@pytest.mark.parametrize(
    ("given", "expected", "reaches"),
    [
        ({}, THIS_MACHINE, False),
        ({RANGE: "LOCALHOST"}, THIS_MACHINE, False),
        (THIS_MACHINE, THIS_MACHINE, False),  # a script started by a script
        ({RANGE: "SUBNET"}, {RANGE: "SUBNET", PROFILE: NETWORK}, True),
        ({RANGE: "subnet"}, {RANGE: "SUBNET", PROFILE: NETWORK}, True),
        ({"ROS_STATIC_PEERS": "10.0.0.2"}, {RANGE: "LOCALHOST", PROFILE: NETWORK}, True),
        ({"ROS_LOCALHOST_ONLY": "1", "ROS_STATIC_PEERS": "10.0.0.2"}, THIS_MACHINE, False),
        ({PROFILE: "mine.xml"}, {RANGE: "LOCALHOST", PROFILE: "mine.xml"}, False),
        ({"OMP_NUM_THREADS": "4"}, {"OMP_NUM_THREADS": "4", "OPENBLAS_NUM_THREADS": "1"}, False),
    ],
)
def test_what_a_user_has_set_stays_and_decides(monkeypatch, given, expected, reaches) -> None:
    _set(monkeypatch, given)
    adopt()
    assert expected.items() <= os.environ.items()
    assert Path(os.environ[PROFILE]).is_file() or os.environ[PROFILE] == "mine.xml"
    assert reaches_other_machines(os.environ) == reaches


_BY_ALL = (
    *("ROS_DISCOVERY_SERVER", "ROS_SUPER_CLIENT", "ROS_LOCALHOST_ONLY", "RCUTILS_COLORIZED_OUTPUT"),
    *("FASTDDS_STATISTICS", "FASTDDS_ENVIRONMENT_FILE", "XDG_CACHE_HOME"),
)
_BY_SCRIPTS = (
    *("PYTHONWARNINGS", "PYTHONHOME", "PYTHONINSPECT", "PYTHON_ANY", "GIT_DIR", "GIT_INDEX_FILE"),
    *("NUMBA_CPU_NAME", "NPY_ANY", "OPENCV_LOG_LEVEL", "TQDM_DISABLE"),
)
_BY_NONE = (
    *("PYTHONDONTWRITEBYTECODE", "NUMBA_CACHE_DIR", "GIT_CONFIG_COUNT", "LD_PRELOAD", "HOME"),
    *("RCUTILS_CONSOLE_OUTPUT_FORMAT", "ROS_DOMAIN_ID", "OPENCV_IO_MAX_IMAGE_PIXELS"),
)


def test_what_is_ignored_goes_by_groups(monkeypatch: pytest.MonkeyPatch) -> None:
    _set(monkeypatch, dict.fromkeys((*_BY_ALL, *_BY_SCRIPTS, *_BY_NONE), "0"))
    monkeypatch.setenv("XDG_CONFIG_HOME", "/there")
    of_nodes, of_scripts = changes(), changes(of_scripts=True)
    assert {name for name, value in of_nodes.items() if value is None} == set(_BY_ALL)
    unset = {name for name, value in of_scripts.items() if value is None}
    assert unset == {*_BY_ALL, *_BY_SCRIPTS}
    assert not of_scripts.keys() & set(_BY_NONE)
    # Neither a profile nor settings of numba in the working directory, nor a module there.
    assert of_scripts.items() >= {"SKIP_DEFAULT_XML_FILE": "1", "PYTHONSAFEPATH": "1"}.items()
    assert of_scripts["NUMBA_DISABLE_JIT"] == "0"
    adopt()
    assert not os.environ.keys() & set(_BY_ALL)
    assert os.environ["XDG_CONFIG_HOME"] == "/there"


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ({}, ""),
        ({RANGE: "SUBNET"}, ""),
        ({RANGE: "OFF"}, "ROS_AUTOMATIC_DISCOVERY_RANGE: expected one of LOCALHOST, .*, got OFF"),
        ({RANGE: "no"}, "ROS_AUTOMATIC_DISCOVERY_RANGE: .*, got NO"),
        ({"ROS_LOG_DIR": "/proc/logs"}, "ROS_LOG_DIR: expected a directory to write to, got /proc"),
        ({"ROS_LOG_DIR": "/dev/null"}, "ROS_LOG_DIR: expected a directory to write to, got /dev"),
        (SECURE, "ROS_SECURITY_KEYSTORE: expected the keys that Enforce asks for, got ''"),
        (SECURE | {"ROS_SECURITY_KEYSTORE": "/"}, ""),
        (SECURE | {"ROS_SECURITY_STRATEGY": "Permissive"}, ""),
    ],
)
def test_what_cannot_be_served_is_named(monkeypatch, given, expected) -> None:
    _set(monkeypatch, given)
    adopt()
    assert re.match(f"{expected}($|[ /])", why_refused())


@pytest.mark.parametrize(
    ("given", "taken"), [("egl", "egl"), ("EGL", "EGL"), ("osmesa", "disable"), ("x", "disable")]
)
def test_opengl_that_is_not_there_is_not_asked_for(monkeypatch, given, taken) -> None:
    monkeypatch.setattr(environment, "find_library", lambda name: name == "EGL")
    monkeypatch.setenv("MUJOCO_GL", given)
    assert changes()["MUJOCO_GL"] == taken


def test_a_loopback_that_is_down_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    class Down(socket.socket):
        def bind(self, address: Any) -> None:
            raise OSError(99, "Cannot assign requested address")

    monkeypatch.setattr(environment.socket, "socket", Down)
    adopt()
    assert "ip link set lo up" in why_refused()
    monkeypatch.setenv(PROFILE, NETWORK)
    assert why_refused() == ""
