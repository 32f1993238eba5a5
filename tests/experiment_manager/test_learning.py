"""The assembled loop learns vergence: a sign turned anywhere in it would make this fail."""

from typing import Any

import numpy as np
import pytest

from experiment_manager import ExperimentManagerConfig, Protocol, make_loop, make_protocol
from eye_plant import StimulusSet
from eye_plant.stimuli.noise import octaves_noise
from lockstep import generator

N_ITERATIONS = 3000
SEED = 1
# A small problem: few basis functions that learn fast, one distance, and an actor in a hurry.
PARAMETERS: dict[str, dict[str, Any]] = {
    "task": {"n_training_iterations": N_ITERATIONS, "n_bases": 64},
    "eyes": {
        "camera.roi_width_px": 130,
        "camera.roi_height_px": 130,
    },
    "sparse_coder": {"learning_rate": 2.0},
    "vergence_rl": {
        "feature_exponent": 0.5,
        "cacla.output_initial_width": 0.2,
        "cacla.actor_learning_rate": 1.0,
        "cacla.exploration_variance": 5e-5,
    },
}


def _pictures(n_pictures: int) -> tuple[np.ndarray, ...]:
    drawn = (octaves_noise(generator(SEED, "picture", i), 512) for i in range(n_pictures))
    return tuple(np.clip(128 + 50 * noise, 0, 255).astype(np.uint8) for noise in drawn)


def _protocol() -> Protocol:
    config = ExperimentManagerConfig(
        seed=SEED,
        n_training_iterations=N_ITERATIONS,
        test_iterations=(N_ITERATIONS,),
        n_training_stimuli=3,
        n_test_stimuli=1,
        n_stimuli_per_test=1,
        object_distance_m=(1.0, 1.0),
    )
    return make_protocol(config)


@pytest.fixture(scope="module")
def training() -> tuple[np.ndarray, np.ndarray]:
    """Train; return of each episode the |vergence error| in deg at its end, and its mean E."""
    pictures = _pictures(4)
    loop = make_loop(PARAMETERS, StimulusSet(pictures[:3], pictures[3:]))
    ends = []
    for episode in _protocol().training_episodes():
        *answered, last = loop.run_episode(episode)
        errors = [
            step.answer.percept.encoding.reconstruction_error.sum()
            for step in answered
            if step.answer
        ]
        ends.append((abs(last.observation.truth.vergence_error_deg), np.mean(errors)))
    loop.plant.close()
    final_error_deg, reconstruction_error = np.array(ends).T
    return final_error_deg, reconstruction_error


def test_the_vergence_error_falls(training: tuple[np.ndarray, np.ndarray]) -> None:
    final_error_deg, _ = training
    n = len(final_error_deg) // 5
    # 0.54; above 1 with the sign of the reward or of the actor's step turned, and with that of the
    # TD error turned the critic diverges.
    assert np.median(final_error_deg[-3 * n :]) < 0.75 * np.median(final_error_deg[:n])


def test_the_reconstruction_error_falls(training: tuple[np.ndarray, np.ndarray]) -> None:
    _, reconstruction_error = training
    n = len(reconstruction_error) // 5
    # It rises with the sign of the dictionaries' step turned.
    assert reconstruction_error[-n:].mean() < 0.9 * reconstruction_error[:n].mean()
