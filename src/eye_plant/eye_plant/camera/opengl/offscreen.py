"""An OpenGL context without a window, with or without a GPU.

MuJoCo's renderer needs a current context; PyOpenGL, which comes with MuJoCo, must be loaded for the
same backend. The environment variable MUJOCO_GL chooses egl or osmesa; without it, or when it is
"disable", as on a machine that had neither at set-up, the first of the two that is there is taken.
"""

import ctypes
import importlib
import os
from types import ModuleType
from typing import Any

from lockstep.errors import InputError

_BACKENDS = ("egl", "osmesa")
_NONE = "disable"
_INSTALL = (
    "install the Debian packages libegl1 and libgl1-mesa-dri (EGL), or libosmesa6 (OSMesa), "
    "for instance: apt-get install libegl1 libgl1-mesa-dri; or draw without OpenGL, with "
    "camera.renderer plane"
)


class GraphicsError(InputError):
    """No picture can be drawn on this machine: the message says why, or what to install."""


def choose_backend() -> str:
    """Return the name of the OpenGL backend to use, egl or osmesa.

    Raises InputError when MUJOCO_GL names another one, GraphicsError when the machine has none.
    """
    wanted = os.environ.get("MUJOCO_GL", "").strip().lower()
    if wanted not in ("", _NONE):
        if wanted not in _BACKENDS:
            raise InputError(f"MUJOCO_GL: expected {' or '.join(_BACKENDS)}, got {wanted}")
        return wanted
    if _has_egl_device():
        return "egl"
    if _load_library("libOSMesa.so.8") or _load_library("libOSMesa.so.6"):
        return "osmesa"
    raise GraphicsError(f"no OpenGL library to draw pictures without a window: {_INSTALL}")


class OffscreenContext:
    """A current OpenGL context of the given size, and the OpenGL functions that go with it.

    Attribute gl: the module OpenGL.GL. One thread at a time may use a context; make_current moves
    it to the calling thread.
    """

    def __init__(self, width_px: int, height_px: int) -> None:
        """Create the context and make it current; GraphicsError when the machine cannot."""
        backend = choose_backend()
        try:
            # Loading these modules loads PyOpenGL for this backend, hence not at the top.
            context_class: Any = importlib.import_module(f"mujoco.{backend}").GLContext
            self._context = context_class(width_px, height_px)
            self._context.make_current()
            self.gl: ModuleType = importlib.import_module("OpenGL.GL")
        except Exception as error:  # PyOpenGL's failures have no common class
            raise GraphicsError(
                f"the OpenGL backend {backend} does not work here "
                f"({type(error).__name__}: {error}): {_INSTALL}; "
                f"MUJOCO_GL chooses between {' and '.join(_BACKENDS)}"
            ) from error

    def make_current(self) -> None:
        """Make this context the calling thread's; quick when it already is."""
        self._context.make_current()

    def close(self) -> None:
        """Free the context and all that was created in it."""
        self._context.free()


def _load_library(name: str) -> ctypes.CDLL | None:
    try:
        return ctypes.CDLL(name)
    except OSError:
        return None


def _has_egl_device() -> bool:
    """Whether EGL is installed together with a driver (libegl1 alone brings none)."""
    library = _load_library("libEGL.so.1")
    if library is None:
        return False
    library.eglGetProcAddress.restype = ctypes.c_void_p
    address = library.eglGetProcAddress(b"eglQueryDevicesEXT")
    if not address:
        return False
    query_devices = ctypes.CFUNCTYPE(
        ctypes.c_uint, ctypes.c_int, ctypes.c_void_p, ctypes.POINTER(ctypes.c_int)
    )(address)
    n_devices = ctypes.c_int(0)
    return bool(query_devices(0, None, ctypes.byref(n_devices))) and n_devices.value > 0
