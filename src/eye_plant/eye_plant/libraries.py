"""Checks what the eyes are simulated with; importing this raises one ImportError if it is not fit.

Another MuJoCo turns the eyes elsewhere without an error: before version 4 their tendons wrap the
long way round the globe. Without its compiler numba calls MuJoCo's functions in vain; the minute
that compiling takes after an installation is announced.
"""

import os
import sys
from typing import Any

_REPAIR = (
    "python3 -m pip uninstall -y mujoco mujoco-core mujoco-studio, then "
    "python3 -m pip install 'mujoco>=4'"
)
_COMPILING = "compiling the simulation, once after an installation or a change (about a minute)"

# Each library has errors of its own, for files as for variables that it cannot use.
try:
    import mujoco

    version = mujoco.__version__
except Exception as error:
    raise ImportError(
        f"expected MuJoCo 4.0 or newer, got none that works ({type(error).__name__}: {error}): "
        f"{_REPAIR}"
    ) from error
if int(version.partition(".")[0]) < 4:
    raise ImportError(
        f"expected MuJoCo 4.0 or newer, got {version} in {mujoco.__path__[0]}: {_REPAIR}"
    )
try:
    import cv2
    import numba
    from numba.core import event

    cv2.getNumThreads()
except Exception as error:
    given = [f"{n}={v}" for n, v in os.environ.items() if n.startswith(("NUMBA_", "OPENCV_"))]
    raise ImportError(
        f"expected numba and OpenCV, got one that does not work ({type(error).__name__}: {error})"
        + (f" with {', '.join(given)}" if given else "")
    ) from error
if numba.config.DISABLE_JIT:
    raise ImportError("expected numba with its compiler, got NUMBA_DISABLE_JIT=1: unset it")


class _Announcement(event.Listener):
    is_due = True

    def on_start(self, event: Any) -> None:
        """Announce the first of our functions that is compiled, rather than loaded from a cache."""
        name = event.data["dispatcher"].py_func.__module__
        if self.is_due and name.startswith("eye_plant."):
            self.is_due = False
            print(_COMPILING, file=sys.stderr, flush=True)

    def on_end(self, event: Any) -> None:
        """Nothing follows."""


event.register("numba:compile", _Announcement())
