"""Trials are drawn in the plane of both activations, from the simulated muscles."""

import numpy as np
import pytest

from active_binocular_vision import Run, groups_of
from active_binocular_vision.figures.runs.motor_space import (
    MotorSpace,
    motor_space,
    motor_space_figure,
)
from eye_plant.inverse.pair import Inverse
from eye_plant.mechanics.mujoco_model import MechanicsConfig


def test_the_motor_space_is_that_of_the_plant() -> None:
    config = MechanicsConfig()
    space = motor_space(config, n_medial=3, n_lateral=2)
    assert space.medial.tolist() == [0.0, 0.1, 0.2]
    assert space.lateral.tolist() == [0.0, 0.1]
    inverse = Inverse(config)
    expected = [[inverse.vergence_deg(m, a) for a in space.lateral] for m in space.medial]
    assert np.allclose(space.vergence_deg, expected, atol=1e-6)
    # OpenEyeSim's map as a power law, both eyes: 2 (2.229 A_MR^0.6 + 2.030 A_LR^0.6) W.
    law_w = 2 * (2.229 * 0.2**0.6 + 2.03 * 0.1**0.6)
    assert space.metabolic_rate_w[2, 1] == pytest.approx(law_w, rel=0.02)


def test_fig_4_draws_each_trial_to_its_end(runs: list[Run]) -> None:
    grid = np.linspace(0, 0.1, 11)
    medial, lateral = np.meshgrid(2 * grid, grid, indexing="ij")
    vergence_deg = 2 * (0.498 + 37.7 * medial - 40.9 * lateral)
    space = MotorSpace(2 * grid, grid, vergence_deg, medial + lateral, 0.056)
    figure = motor_space_figure(space, groups_of(runs))
    near, far = figure.axes[:2]
    # At 0.5 m there are trials from -3, -1, 1, 3 deg; at 6 m only from -3 and -1.
    for axes, distance_m, starts_deg in ((near, 0.5, (-3, -1, 1, 3)), (far, 6.0, (-3, -1))):
        paths = [line for line in axes.lines if len(np.asarray(line.get_xdata())) == 21]
        assert len(paths) == 2 * len(starts_deg)
        trials = runs[0].tests[400]
        for path, start_deg in zip(paths, starts_deg, strict=False):
            (i_trial,) = np.flatnonzero(
                (trials.object_distance_m == distance_m)
                & (np.abs(trials.vergence_error_deg[:, 0] - start_deg) < 1e-6)
            )
            found = np.stack([path.get_ydata(), path.get_xdata()], axis=1)
            assert np.array_equal(found, runs[0].tests[400].activations[i_trial])
    assert near.get_title("left").endswith("object at 0.5 m, 4 trials of each model")
    assert far.get_title("left").endswith("object at 6 m, 2 trials of each model")
    figure = motor_space_figure(space, groups_of([runs[0], *runs]))
    assert figure.axes[0].get_title("left").endswith("object at 0.5 m, trials: 8 of M, 4 of M_C")


def test_ends_of_both_models_in_one_point_can_be_told_apart(runs: list[Run]) -> None:
    grid = np.linspace(0, 0.1, 3)
    space = MotorSpace(2 * grid, grid, np.eye(3), np.eye(3), 0.056)
    near = motor_space_figure(space, groups_of(runs)).axes[0]
    ends = [line for line in near.lines if len(np.asarray(line.get_xdata())) == 1]
    looks = {(line.get_marker(), line.get_markersize(), line.get_color()) for line in ends}
    assert len(looks) == 2
    (below, *_), (above, *_) = (
        [line for line in ends if line.get_marker() == marker] for marker in ("o", "D")
    )
    assert below.get_markersize() > 1.5 * above.get_markersize()
    assert below.get_zorder() < above.get_zorder(), "the smaller one lies on the larger one"
