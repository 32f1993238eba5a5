from pathlib import Path

import cv2
import numpy as np
import pytest

from active_binocular_vision.examinations.landscape import reward_landscape
from eye_plant import EyePlant, EyePlantConfig, StimulusSet
from eye_plant.mechanics.model import MechanicsConfig
from lockstep import InputError, read_state
from sparse_coder import SparseCoder, SparseCoderConfig

RESULTS = Path(__file__).parents[3] / "results"
LEARNED = RESULTS / "paper_short/seed_1-model_M/checkpoints/000023120/sparse_coder.npz"


@pytest.fixture(scope="module")
def plant():
    noise = np.random.default_rng(0).integers(0, 256, (2, 150, 150), dtype=np.uint8)
    pictures = tuple(cv2.resize(n, (900, 900), interpolation=cv2.INTER_LINEAR) for n in noise)
    plant = EyePlant(EyePlantConfig(), StimulusSet((), pictures))
    yield plant
    plant.close()


@pytest.fixture(scope="module")
def coder():
    coder = SparseCoder(SparseCoderConfig())
    coder.restore(read_state(LEARNED, "sparse_coder"))
    return coder


def landscape(
    plant, coder, stimuli=(0,), distances_m=(2.0,), errors_deg=(-1.0, -0.5, 0.0, 0.5, 1.0)
):
    return reward_landscape(
        plant,
        EyePlantConfig().mechanics,
        coder,
        stimuli=stimuli,
        distances_m=distances_m,
        vergence_errors_deg=errors_deg,
    )


def test_learned_basis_functions_code_best_what_both_eyes_fixate(plant, coder):
    errors_deg = np.array([-1.0, -0.5, -0.2, 0.0, 0.2, 0.5, 1.0])
    found = landscape(plant, coder, (0, 1), (1.0, 3.0), errors_deg)
    total = found.total_error
    assert errors_deg[total.argmin()] == 0.0
    assert (np.diff(total[:4]) < 0.0).all()
    assert (np.diff(total[3:]) > 0.0).all()
    assert found.depth == pytest.approx(1.0 - total.min() / total.mean())
    assert found.left_share == pytest.approx(0.5, abs=0.02)
    assert found.use.sum(axis=1) == pytest.approx([1.0, 1.0])


def test_dictionaries_that_have_not_learned_have_a_flat_landscape(plant, coder):
    untrained = SparseCoder(SparseCoderConfig())
    assert landscape(plant, untrained).depth < 0.5 * landscape(plant, coder).depth


def test_a_vergence_that_no_muscles_reach_has_no_place_in_the_landscape(plant, coder):
    found = landscape(plant, coder, errors_deg=(-500.0, 0.0))
    assert np.isnan(found.reconstruction_error[0]).all()
    assert np.isfinite(found.reconstruction_error[1]).all()


def test_a_vergence_at_which_eyes_may_rest_in_two_ways_has_no_place_either(coder):
    # Found by chance, among muscles that no surgeon leaves.
    mechanics = MechanicsConfig(
        parameter_set="anatomical",
        strength=(0.1, 0.5, 0.1, 0.5, 0.1, 0.1, 2.0, 0.5, 0.5, 1.0, 1.0, 0.1),
        recession_mm=(0.0, 0.0, 8.0, -8.0, -8.0, -8.0, -8.0, -8.0, 0.0, 8.0, 0.0, 0.0),
    )
    pictures = (np.random.default_rng(0).integers(0, 256, (64, 64), dtype=np.uint8),)
    plant = EyePlant(EyePlantConfig(mechanics=mechanics), StimulusSet((), pictures))
    try:
        found = reward_landscape(
            plant,
            mechanics,
            coder,
            stimuli=(0,),
            distances_m=(2.0,),
            vergence_errors_deg=(-30.0, 0.0),
        )
    finally:
        plant.close()
    assert np.isnan(found.reconstruction_error[0]).all()
    assert np.isfinite(found.reconstruction_error[1]).all()


def test_a_landscape_of_nothing_is_refused(plant, coder):
    with pytest.raises(InputError, match="at least one stimulus, distance and vergence error"):
        landscape(plant, coder, stimuli=())
