"""Which OpenGL is taken to draw without a window."""

import pytest

from eye_plant.camera.opengl.offscreen import GraphicsError, choose_backend
from lockstep.errors import InputError


def test_a_machine_without_graphics_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    monkeypatch.setattr("eye_plant.camera.opengl.offscreen._load_library", lambda _: None)
    with pytest.raises(GraphicsError, match=r"libegl1 and libgl1-mesa-dri .* or libosmesa6"):
        choose_backend()


def test_osmesa_is_taken_where_egl_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    monkeypatch.setattr(
        "eye_plant.camera.opengl.offscreen._load_library", lambda name: "OSMesa" in name or None
    )
    assert choose_backend() == "osmesa"


def test_the_environment_chooses_the_backend(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MUJOCO_GL", "OSMesa")
    assert choose_backend() == "osmesa"
    monkeypatch.setenv("MUJOCO_GL", "vulkan")
    with pytest.raises(InputError, match="MUJOCO_GL: expected egl or osmesa, got vulkan"):
        choose_backend()
