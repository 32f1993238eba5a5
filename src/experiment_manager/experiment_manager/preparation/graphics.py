"""Whether the renderer of a run works here; a new run that names none takes one that does."""

from collections.abc import Collection
from dataclasses import replace

from experiment_manager.experiment.sections import Configuration, config_of
from experiment_manager.preparation.configuration import configuration_of, profile_of
from experiment_manager.preparation.request import RunRequest
from eye_plant.camera.config import MUJOCO, PLANE
from eye_plant.camera.opengl.offscreen import GraphicsError, OffscreenContext
from eye_plant.config import EyePlantConfig

_NODE, _PARAMETER = "eye_plant", "camera.renderer"
_KEY = f"eyes.{_PARAMETER}"


def check_graphics(configuration: Configuration, elsewhere: Collection[str]) -> None:
    """Raise GraphicsError when the plant is to draw with an OpenGL that does not work here.

    elsewhere: nodes on another machine. In a node the cause might be a lack of memory: see there.
    """
    plant = config_of(EyePlantConfig, configuration)
    if plant.camera.renderer == MUJOCO and _NODE not in elsewhere:
        OffscreenContext(64, 64).close()


def drawable_configuration(
    request: RunRequest, commit: str, elsewhere: Collection[str]
) -> Configuration:
    """Return the configuration of a new run that can be drawn here.

    Without OpenGL the plane is drawn by the ray caster, and a line on stdout says so. Raises
    GraphicsError when the request or its profile names a renderer that does not work here, and
    InputError as configuration_of does.
    """
    configuration = configuration_of(request, commit)
    try:
        check_graphics(configuration, elsewhere)
    except GraphicsError:
        is_named = _KEY in request.overrides
        if is_named or _PARAMETER in profile_of(request).settings.get("eyes", {}):
            raise
        print(
            f"OpenGL does not work here: {_KEY} is {PLANE}, which needs none; "
            f"--set {_KEY}={MUJOCO} shows what is missing"
        )
        plane = replace(request, overrides={**request.overrides, _KEY: PLANE})
        return configuration_of(plane, commit)
    return configuration
