"""A plant that is changed between two episodes is as one that was made so."""

import mujoco
import numpy as np
import pytest

from eye_plant.camera.opengl.offscreen import GraphicsError
from eye_plant.config import EyePlantConfig, changed
from eye_plant.episode import Episode
from eye_plant.plant import EyePlant
from eye_plant.stimuli.stereograms import random_dot_stereograms
from eye_plant.stimuli.stimulus_set import StimulusSet
from lockstep.configuration import build
from lockstep.errors import InputError
from tests.pair import pair_activations

ALTERED = {
    "mechanics.rest_adduction_deg": [0.0, 2.0],
    "mechanics.baseline_m": 0.062,
    "camera.left_blur_px": 3.0,
    "camera.right_magnification": 1.1,
}


@pytest.fixture(scope="module")
def stimuli():
    noise = np.random.default_rng(0).integers(0, 256, (300, 300), dtype=np.uint8)
    return StimulusSet((noise,), (), random_dot_stereograms(seed=2, n=1, size_px=300))


@pytest.fixture(scope="module")
def plain():
    return build(EyePlantConfig, {"camera.renderer": "plane"})


def made(config, stimuli):
    return EyePlant(config, stimuli)


def seen(plant, stimulus=0):
    episode = Episode.alone(stimulus, 1.0, pair_activations(0.04, 0.01), n_iterations=2)
    first = plant.begin(episode)
    second = plant.execute(plant.targets(["medial_rectus", "lateral_rectus"], np.array([0.05, 0])))
    return [
        (o.pictures.tobytes(), o.ground_truth_values(), o.state.eye_angles_rad.tobytes())
        for o in (first, second)
    ]


def test_a_changed_plant_is_as_one_made_so_and_back(plain, stimuli):
    plant, anew = made(plain, stimuli), made(changed(plain, ALTERED), stimuli)
    before, expected = seen(plant), seen(anew)
    assert before != expected
    plant.reconfigure(ALTERED)
    assert seen(plant) == expected
    plant.reconfigure({})
    assert seen(plant) == before
    plant.close()
    anew.close()


def test_a_refused_change_leaves_the_plant_as_it_was(plain, stimuli):
    plant = made(plain, stimuli)
    before = seen(plant)
    for settings, message in (
        ({"camera.left_blur_px": -1.0}, "left_blur_px: expected 0 px or more"),
        ({"camera.width_px": 64}, "camera.width_px: expected the same for a whole run"),
        ({"mechanics.control_period_s": 0.1}, "control_period_s: expected the same"),
        ({"camera.blur": 1.0}, "unknown parameter camera.blur"),
    ):
        with pytest.raises(InputError, match=message):
            plant.reconfigure(settings)
    assert seen(plant) == before
    plant.close()


@pytest.mark.parametrize("mechanics", [{}, {"mechanics.baseline_m": 0.062}])
def test_a_change_that_cannot_be_drawn_leaves_the_plant_as_it_was(stimuli, mechanics, monkeypatch):
    plant = made(build(EyePlantConfig, {"camera.renderer": "mujoco"}), stimuli)
    before = seen(plant)

    def refuse(*_: object) -> None:
        raise mujoco.FatalError("out of memory")

    with monkeypatch.context() as broken:
        broken.setattr(mujoco, "MjrContext", refuse)
        with pytest.raises(GraphicsError, match="out of memory"):
            plant.reconfigure({**mechanics, "camera.left_magnification": 1.1})
    plant.reconfigure({})
    assert seen(plant) == before
    plant.reconfigure(ALTERED)
    assert seen(plant) != before
    plant.close()


def test_the_eyes_should_meet_where_a_stereograms_dots_fuse(plain, stimuli):
    plant = made(plain, stimuli)
    (shown,) = stimuli.stereograms
    parallax_m = shown.parallax * 3.0
    assert parallax_m != 0.0
    desired_deg = seen(plant, stimulus=1)[0][1][10]
    assert desired_deg == pytest.approx(np.degrees(2 * np.arctan((0.056 + parallax_m) / 2.0)))
    plant.close()
