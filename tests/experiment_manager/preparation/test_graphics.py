"""Which renderer a new run takes on a machine without OpenGL."""

from functools import partial
from pathlib import Path

import pytest

from experiment_manager.preparation import configuration
from experiment_manager.preparation.graphics import drawable_configuration
from experiment_manager.preparation.profiles import parse_profile
from experiment_manager.preparation.request import RunRequest
from experiment_manager.run.config_file import Configuration
from eye_plant.camera.opengl.offscreen import GraphicsError

_KEY = "eyes.camera.renderer"


@pytest.fixture(autouse=True)
def without_opengl(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    monkeypatch.setattr("eye_plant.camera.opengl.offscreen._load_library", lambda _: None)


def _renderer(found: Configuration) -> str:
    return str(found["eyes"]["camera.renderer"])


def test_a_run_that_names_none_takes_the_ray_caster(pictures, capsys) -> None:
    request = RunRequest(profile="paper", stimuli=str(pictures))
    found = drawable_configuration(request, "", ())
    assert _renderer(found) == "plane"
    expected = configuration.configuration_of(request, "")
    expected["eyes"]["camera.renderer"] = "plane"
    assert found == expected
    (line,) = capsys.readouterr().out.splitlines()
    assert f"{_KEY} is plane" in line


def test_a_plant_on_another_machine_may_have_opengl(pictures, capsys) -> None:
    request = RunRequest(profile="paper", stimuli=str(pictures))
    assert _renderer(drawable_configuration(request, "", ("eye_plant",))) == "mujoco"
    assert capsys.readouterr().out == ""


def test_a_renderer_that_the_request_names_is_taken_or_refused(pictures: Path) -> None:
    named = partial(RunRequest, profile="paper", stimuli=str(pictures))
    plane = drawable_configuration(named(overrides={_KEY: "plane"}), "", ())
    assert _renderer(plane) == "plane"
    with pytest.raises(GraphicsError, match="no OpenGL library"):
        drawable_configuration(named(overrides={_KEY: "mujoco"}), "", ())


def test_a_renderer_that_the_profile_names_is_taken_or_refused(pictures, monkeypatch) -> None:
    text = "description: x\nbase: paper\nsettings: {eye_plant: {camera.renderer: mujoco}}"
    monkeypatch.setattr(configuration, "read_profile", lambda name: parse_profile(name, text))
    with pytest.raises(GraphicsError, match="no OpenGL library"):
        drawable_configuration(RunRequest(stimuli=str(pictures)), "", ())
