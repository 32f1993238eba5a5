"""Whether MuJoCo's renderer, the oracle of the project's own, works here."""

from functools import cache

import mujoco
import pytest


def need_opengl() -> None:
    """Skip the test, with the reason, where MuJoCo's renderer lacks OpenGL."""
    if reason := _why_not():
        pytest.skip(reason)


@cache
def _why_not() -> str:
    try:
        mujoco.Renderer(mujoco.MjModel.from_xml_string("<mujoco/>")).close()
    except Exception as error:  # the backends' failures have no common class
        return f"no OpenGL here, install libegl1 and libgl1-mesa-dri ({error})"
    return ""
