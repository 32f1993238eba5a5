"""The environment variables of a run: which it ignores, which it sets, which it cannot serve.

What has no group here stays as it is, such as paths, proxies, the locale, preloaded libraries. As a
program, with only the standard library, it prints what becomes of the variables, as commands of a
shell: for launch_scripts, and with the word pip for pip, whose `config list` it reads.
"""

import ast
import os
import shlex
import socket
import sys
import tempfile
from collections.abc import Iterable, Mapping
from ctypes.util import find_library
from fnmatch import fnmatchcase
from pathlib import Path

_RANGE, _PROFILE = "ROS_AUTOMATIC_DISCOVERY_RANGE", "FASTRTPS_DEFAULT_PROFILES_FILE"
_LOCALHOST_ONLY, _PEERS, _LOG = "ROS_LOCALHOST_ONLY", "ROS_STATIC_PEERS", "ROS_LOG_DIR"
_PIP, _GL = "PIP_", "MUJOCO_GL"

# How names begin, and how those among them begin that stay.
_Groups = Mapping[str, tuple[str, ...]]
# Ignored by all nodes. They meet without a server.
_IGNORED: _Groups = {
    "ROS_DISCOVERY_SERVER": (),
    "ROS_SUPER_CLIENT": (),
    _LOCALHOST_ONLY: (),  # Jazzy's older word for a range
    "FASTDDS_": ("FASTDDS_BUILTIN_TRANSPORTS",),
    "RCUTILS_": ("RCUTILS_CONSOLE_OUTPUT_FORMAT",),
}
# Ignored by the scripts besides, which have packages of their own, and numbers that only they make.
_IGNORED_BY_SCRIPTS: _Groups = {
    "PYTHON": ("PYTHONDONTWRITEBYTECODE", "PYTHONFAULTHANDLER", "PYTHONPYCACHEPREFIX"),
    "AMENT_PREFIX_PATH": (),
    "_ROS_WHEELS_BOOTSTRAP_COMPLETE": (),
    "RMW_IMPLEMENTATION": (),  # there is only one
    "RCL_ASSERT_RMW_ID_MATCHES": (),
    "GIT_": ("GIT_CONFIG", "GIT_SSH", "GIT_SSL"),
    "NUMBA_": ("NUMBA_CACHE_DIR",),
    "NPY_": (),
    "OPENCV_": ("OPENCV_IO_",),
    "TQDM_": (),
}
_DEFAULTS = {
    "RMW_IMPLEMENTATION": "rmw_fastrtps_cpp",
    _RANGE: "LOCALHOST",
    # Each process works on matrices too small to share out; threads would only fight for the cores.
    "OPENBLAS_NUM_THREADS": "1",
    "OMP_NUM_THREADS": "1",
    "OPENCV_FOR_THREADS_NUM": "1",
    _GL: "disable",  # the OpenGL that MuJoCo loads: our own renderer needs none
}
# Whatever files lie in the working directory: profiles of Fast DDS, settings of numba, modules.
_ALWAYS = {
    "SKIP_DEFAULT_XML_FILE": "1",
    "NUMBA_DISABLE_JIT": "0",  # compiled mechanics would not move
    "PYTHONSAFEPATH": "1",
    "PYTHONUTF8": "1",  # in any locale: paths may have umlauts, and ROS reads all as UTF-8
    "PYTHONUNBUFFERED": "1",  # what is said first is shown first, also through a pipe
}
# A relative one is to be ignored, says the specification; an empty one, too.
_FOLDERS = ("XDG_CACHE_HOME", "XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_STATE_HOME")
_OPENGL = {"egl": "EGL", "osmesa": "OSMesa", "glfw": "GL"}
_RANGES = ("LOCALHOST", "SUBNET", "SYSTEM_DEFAULT")
_THIS_MACHINE, _NETWORK = "this_machine.xml", "network.xml"
# What pip is told of where packages come from. The rest, such as another target, is not for us.
_OF_PIP = (
    *("index-url", "extra-index-url", "find-links", "no-index", "trusted-host", "proxy", "cert"),
    *("client-cert", "keyring-provider", "use-feature", "use-deprecated", "timeout", "retries"),
    *("default-timeout", "cache-dir", "no-cache-dir"),
)
_SECTIONS_OF_PIP = ("global", "install", ":env:")  # the last one has the last word


def changes(*, of_scripts: bool = False) -> dict[str, str | None]:
    """Return what becomes of the variables of this process, by name: None for those to be unset.

    of_scripts: of those for which all packages come from an environment of their own.
    """
    groups = {**_IGNORED, **(_IGNORED_BY_SCRIPTS if of_scripts else {})}
    ignored = {
        name: None
        for name in os.environ
        for group, kept in groups.items()
        if name.startswith(group) and not (kept and name.startswith(kept))
    }
    ignored |= {name: None for name in _FOLDERS if not os.environ.get(name, "/").startswith("/")}
    found = {name: value for name, value in os.environ.items() if name not in ignored}
    changed = ignored | {name: found.get(name) or value for name, value in _DEFAULTS.items()}
    changed[_RANGE] = str(changed[_RANGE]).upper()
    library = _OPENGL.get(str(changed[_GL]).lower())
    if not (library and find_library(library)):  # MuJoCo would not be imported
        changed[_GL] = _DEFAULTS[_GL]
    if os.environ.get(_LOCALHOST_ONLY) == "1":  # as ROS takes it
        changed |= {_RANGE: "LOCALHOST", _PEERS: None}
        found.pop(_PEERS, None)
    if not found.get(_PROFILE):
        # The profile for this machine takes the place of LOCALHOST, with which ROS adds shared
        # memory.
        stays = changed[_RANGE] == "LOCALHOST" and not found.get(_PEERS)
        profile = Path(__file__).with_name(_THIS_MACHINE if stays else _NETWORK)
        changed |= {_PROFILE: str(profile)} | ({_RANGE: "SYSTEM_DEFAULT"} if stays else {})
    if of_scripts and "LD_LIBRARY_PATH" in found:
        changed["LD_LIBRARY_PATH"] = _without_other_ros(found["LD_LIBRARY_PATH"].split(":"))
    return changed | _ALWAYS


def adopt() -> None:
    """Change the variables of this process so, for ROS in it and for the processes it starts."""
    for name, value in changes().items():
        if value is None:
            os.environ.pop(name, None)
        else:
            os.environ[name] = value


def why_refused() -> str:
    """Return what nodes would lack with the variables of this process, adopted, or ""."""
    if os.environ[_RANGE] not in _RANGES:
        return f"{_RANGE}: expected one of {', '.join(_RANGES)}, got {os.environ[_RANGE]}"
    if _is_secured() and os.environ.get("ROS_SECURITY_STRATEGY") == "Enforce":
        keys = os.environ.get("ROS_SECURITY_KEYSTORE", "")
        if not Path(keys or "/nowhere").is_dir():
            return f"ROS_SECURITY_KEYSTORE: expected the keys that Enforce asks for, got {keys!r}"
    if directory := os.environ.get(_LOG):
        try:
            Path(directory).expanduser().mkdir(parents=True, exist_ok=True)
            tempfile.TemporaryFile(dir=Path(directory).expanduser()).close()
        except (OSError, RuntimeError) as error:
            return f"{_LOG}: expected a directory to write to, got {directory} ({error})"
    if _stays_here():
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            try:
                probe.bind(("127.0.0.1", 0))
            except OSError as error:
                return f"expected a loopback interface (ip link set lo up), got none: {error}"
    return ""


def is_usual() -> bool:
    """Return whether nodes with the variables of this process, adopted, meet as by default."""
    return _stays_here() and not _is_secured()


def _stays_here() -> bool:
    return Path(os.environ.get(_PROFILE, "")).name == _THIS_MACHINE


def _is_secured() -> bool:
    return os.environ.get("ROS_SECURITY_ENABLE") == "true"


def reaches_other_machines(environment: Mapping[str, str]) -> bool:
    """Return whether nodes with these variables may hear those of other machines."""
    if environment.get(_PEERS):
        return True
    is_ours = Path(environment.get(_PROFILE, "")).name == _THIS_MACHINE
    return not is_ours and environment.get(_RANGE) != "LOCALHOST"


def _without_other_ros(folders: Iterable[str]) -> str | None:
    others = ("/opt/ros/*", "*/ros_*.libs")
    kept = (f for f in folders if f and not any(fnmatchcase(f, other) for other in others))
    return ":".join(kept) or None


def _changes_for_pip(settings: Iterable[str]) -> dict[str, str | None]:
    """Return what becomes of pip's variables; settings: lines SECTION.NAME='VALUE'."""
    found: dict[tuple[str, str], str] = {}
    for line in settings:
        key, _, value = line.partition("=")
        section, _, name = key.rpartition(".")
        if name in _OF_PIP:
            found[section, name] = ast.literal_eval(value)
    own = {
        f"{_PIP}{name.upper().replace('-', '_')}": value
        for section in _SECTIONS_OF_PIP
        for (of, name), value in found.items()
        if of == section
    }
    ignored = dict.fromkeys(name for name in os.environ if name.startswith(_PIP))
    return {**ignored, f"{_PIP}CONFIG_FILE": os.devnull, **own}


if __name__ == "__main__":
    chosen = _changes_for_pip(sys.stdin) if "pip" in sys.argv[1:] else changes(of_scripts=True)
    for name, value in chosen.items():
        if name.isidentifier():  # a shell knows no others
            print(f"unset {name}" if value is None else f"export {name}={shlex.quote(value)}")
