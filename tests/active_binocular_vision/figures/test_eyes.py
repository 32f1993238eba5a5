"""The eyes as they are drawn, against the plant's own numbers and against what a face shows."""

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from active_binocular_vision.figures.eyes import DrawnEyes
from eye_plant.mechanics.mujoco_model import MechanicsConfig
from eye_plant.mechanics.oculomotor import Oculomotor
from lockstep.command_space import MUSCLE_NAMES

CONFIG = MechanicsConfig(parameter_set="anatomical")


@pytest.fixture
def eyes() -> DrawnEyes:
    """Eyes in an empty figure."""
    figure = Figure()
    FigureCanvasAgg(figure)
    return DrawnEyes(figure.add_subplot(), CONFIG, highest=0.2)


def _pupils(eyes: DrawnEyes) -> np.ndarray:
    """Return the centres of both pupils (2, 2), the left eye's first."""
    shown = [p for p in eyes.axes.patches if isinstance(p, Polygon)]
    return np.array([pupil.get_xy()[:-1].mean(axis=0) for pupil in shown[1::2]])


@pytest.mark.parametrize(
    ("turn", "left_moves", "right_moves"),
    [
        # Seen from the front, the left eye is on the right: to the nose is to the left.
        ((1, 0, 0), (-1, 0), (1, 0)),
        ((0, 1, 0), (0, 1), (0, 1)),
    ],
)
def test_pupils_turn_to_the_nose_and_up(eyes, turn, left_moves, right_moves) -> None:
    activations = np.full(12, 0.1)
    eyes.show(np.zeros(6), activations)
    before = _pupils(eyes)
    eyes.show(np.radians(10.0) * np.array([*turn, *turn]), activations)
    moved_mm = _pupils(eyes) - before
    for of_eye, expected in zip(moved_mm, (left_moves, right_moves), strict=True):
        assert np.sign(of_eye.round(1)[np.array(expected) != 0]).tolist() == [
            sign for sign in expected if sign
        ]
    assert before[0, 0] > before[1, 0]


def test_the_path_of_a_muscle_is_as_long_as_the_plant_says(eyes) -> None:
    plant = Oculomotor(CONFIG)
    activations = plant.tonic_activations
    activations[[0, 6]] += 0.1
    plant.settle(activations)
    eyes.show(plant.state().eye_angles_rad.ravel(), activations)
    for i_muscle, length_m in enumerate(plant.state().lengths_m):
        steps_mm = np.diff(eyes.path_mm(i_muscle), axis=0)
        assert np.linalg.norm(steps_mm, axis=1).sum() == pytest.approx(1e3 * length_m, rel=1e-3)


def test_each_muscle_has_the_colour_of_its_activation(eyes) -> None:
    activations = np.linspace(0.0, 0.2, len(MUSCLE_NAMES))
    eyes.show(np.zeros(6), activations)
    drawn = {
        tuple(np.round(colour, 3))
        for lines in eyes.axes.collections
        if isinstance(lines, LineCollection)
        for colour in lines.get_colors()
    }
    expected = {tuple(np.round(eyes.colours.to_rgba(a), 3)) for a in activations}
    assert len(expected) == len(MUSCLE_NAMES)
    assert expected <= drawn
