"""The environment of every node, for launch files: what launch_scripts/environment.sh exports."""

import os
from pathlib import Path

_DEFAULTS = {
    "RMW_IMPLEMENTATION": "rmw_fastrtps_cpp",
    "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
    # Each process works on matrices too small to share out; threads would only fight for the cores.
    "OPENBLAS_NUM_THREADS": "1",
    "OMP_NUM_THREADS": "1",
    "OPENCV_FOR_THREADS_NUM": "1",
    "MUJOCO_GL": "disable",
    "PYTHONUTF8": "1",
    "PYTHONUNBUFFERED": "1",
}


def launch_environment(share: Path) -> dict[str, str]:
    """Return the variables of the nodes; those that the user has set stay as they are.

    share: share directory of the installed package lockstep, with the profile of Fast DDS.
    """
    profile = str(share / "config" / "fastdds.xml")
    defaults = _DEFAULTS | {"FASTRTPS_DEFAULT_PROFILES_FILE": profile}
    return {name: os.environ.get(name, value) for name, value in defaults.items()}
