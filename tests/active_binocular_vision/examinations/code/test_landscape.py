from pathlib import Path
from types import SimpleNamespace
from typing import Any

import cv2
import numpy as np
import pytest

from active_binocular_vision.examinations.code.landscape import depth_of, reward_landscape
from active_binocular_vision.learners.basis_functions import left_share
from active_binocular_vision.learners.session import Session
from experiment_manager import InProcessLoop
from eye_plant import EyePlant, EyePlantConfig, StimulusSet
from eye_plant.mechanics.mujoco_model import MechanicsConfig
from lockstep import read_state
from sparse_coder import SparseCoder, SparseCoderConfig
from vergence_rl import Agent, VergenceRlConfig

RESULTS = Path(__file__).parents[4] / "results"
LEARNED = RESULTS / "precise/sparse_coder_seed_1.npz"
ERRORS_DEG = (-1.0, -0.5, 0.0, 0.5, 1.0)


@pytest.fixture(scope="module")
def coder() -> SparseCoder:
    coder = SparseCoder(SparseCoderConfig())
    coder.restore(read_state(LEARNED, "sparse_coder"))
    return coder


@pytest.fixture(scope="module")
def pictures() -> StimulusSet:
    noise = np.random.default_rng(0).integers(0, 256, (2, 150, 150), dtype=np.uint8)
    return StimulusSet(
        (), tuple(cv2.resize(n, (900, 900), interpolation=cv2.INTER_LINEAR) for n in noise)
    )


def session(coder: SparseCoder, pictures: StimulusSet, plant: EyePlantConfig) -> Session:
    learners: Any = SimpleNamespace(plant=plant, manager=None)
    loop = InProcessLoop(EyePlant(plant, pictures), coder, Agent(VergenceRlConfig()))
    return Session(learners, loop, pictures)


def test_learned_basis_functions_code_best_what_both_eyes_fixate(coder, pictures) -> None:
    errors_deg = np.array([-1.0, -0.5, -0.2, 0.0, 0.2, 0.5, 1.0])
    eyes = session(coder, pictures, EyePlantConfig())
    errors, features = reward_landscape(eyes, (1.0, 3.0), errors_deg.tolist())
    total = errors.sum(axis=1)
    assert errors_deg[total.argmin()] == 0.0
    assert (np.diff(total[:4]) < 0.0).all()
    assert (np.diff(total[3:]) > 0.0).all()
    assert left_share(features, coder.atoms()) == pytest.approx(0.5, abs=0.02)
    untrained = session(SparseCoder(SparseCoderConfig()), pictures, EyePlantConfig())
    flat, _ = reward_landscape(untrained, (2.0,), ERRORS_DEG)
    assert depth_of(flat.sum(axis=1)) < 0.5 * depth_of(total)


def test_the_depth_is_that_of_the_errors_that_are_known() -> None:
    assert depth_of(np.array([0.6, np.nan, 0.2])) == pytest.approx(0.5)
    assert np.isnan(depth_of(np.array([np.nan])))


# The second has eyes that may rest in two ways: found by chance, among muscles that no surgeon
# leaves.
@pytest.mark.parametrize(
    ("mechanics", "error_deg"),
    [
        (MechanicsConfig(), -500.0),
        (
            MechanicsConfig(
                parameter_set="anatomical",
                strength=(0.1, 0.5, 0.1, 0.5, 0.1, 0.1, 2.0, 0.5, 0.5, 1.0, 1.0, 0.1),
                recession_mm=(0.0, 0.0, 8.0, -8.0, -8.0, -8.0, -8.0, -8.0, 0.0, 8.0, 0.0, 0.0),
            ),
            -30.0,
        ),
    ],
)
def test_a_vergence_that_eyes_do_not_reach_has_no_place(
    coder, pictures, mechanics, error_deg
) -> None:
    eyes = session(coder, pictures, EyePlantConfig(mechanics=mechanics))
    errors, _ = reward_landscape(eyes, (2.0,), (error_deg, 0.0))
    assert np.isnan(errors[0]).all()
    assert np.isfinite(errors[1]).all()
