"""The environment variables of every node, for launch files and for launch_scripts/environment.sh.

As a program, with only the standard library, it prints them as commands of a shell.
"""

import os
import shlex
import sys
from collections.abc import Mapping
from pathlib import Path

_RANGE, _PROFILE = "ROS_AUTOMATIC_DISCOVERY_RANGE", "FASTRTPS_DEFAULT_PROFILES_FILE"
_DEFAULTS = {
    "RMW_IMPLEMENTATION": "rmw_fastrtps_cpp",
    _RANGE: "LOCALHOST",
    # Each process works on matrices too small to share out; threads would only fight for the cores.
    "OPENBLAS_NUM_THREADS": "1",
    "OMP_NUM_THREADS": "1",
    "OPENCV_FOR_THREADS_NUM": "1",
    "MUJOCO_GL": "disable",  # the OpenGL that MuJoCo loads: our own renderer needs none
    "PYTHONUTF8": "1",  # in any locale: paths may have umlauts, and ROS reads all as UTF-8
    "PYTHONUNBUFFERED": "1",  # what is said first is shown first, also through a pipe
}
_THIS_MACHINE, _NETWORK = "this_machine.xml", "network.xml"


def node_environment(config: Path) -> dict[str, str]:
    """Return the variables of the nodes; those that the user has set stay as they are.

    config: the directory of the package lockstep with the profiles of Fast DDS. The one for this
    machine takes the place of the discovery range LOCALHOST, with which ROS adds shared memory.
    """
    variables = {name: os.environ.get(name) or value for name, value in _DEFAULTS.items()}
    profile = os.environ.get(_PROFILE, "")
    if not profile:
        stays = variables[_RANGE] == "LOCALHOST" and not os.environ.get("ROS_STATIC_PEERS")
        profile = str(config / (_THIS_MACHINE if stays else _NETWORK))
        if stays:
            variables[_RANGE] = "SYSTEM_DEFAULT"
    return variables | {_PROFILE: profile}


def reaches_other_machines(environment: Mapping[str, str]) -> bool:
    """Return whether nodes with these variables may hear those of other machines."""
    if environment.get("ROS_STATIC_PEERS"):
        return True
    is_ours = Path(environment.get(_PROFILE, "")).name == _THIS_MACHINE
    return not is_ours and environment.get(_RANGE) != "LOCALHOST"


if __name__ == "__main__":
    for name, value in node_environment(Path(sys.argv[1])).items():
        print(f"export {name}={shlex.quote(value)}")
