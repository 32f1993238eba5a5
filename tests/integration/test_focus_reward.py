"""Which reward is best where both eyes are in focus and converged, on rendered stimuli."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from eye_plant.camera.config import CameraConfig
from eye_plant.lens.lenses import LensState
from eye_plant.stereo_camera import StereoCamera
from eye_plant.stimuli.stimulus_set import StimuliConfig, load_stimuli
from eye_plant.turns import eye_rotations
from eye_plant.vergence import desired_vergence_deg
from lockstep.scales import ScalesConfig
from sparse_coder import Encoding, SparseCoder, SparseCoderConfig

BASELINE_M, DISTANCE_M = 0.056, 1.0
N_TRAINING, N_TEST, N_VIEWS = 6, 6, 240
SCALES = ScalesConfig(
    names=("fine", "fine_whitened", "foveal"),
    window_px=(40, 40, 40),
    size_px=(40, 40, 40),
    zoom=(1.0, 1.0, 4.0),
    focus_d=(0.0, 0.0, 0.0),
    n_for_lenses=2,
)
CODER = SparseCoderConfig(
    command_space="pair_and_lens",
    lowest_activations=(0.0,),
    highest_activations=(0.2,),
    n_bases=100,
    scales=SCALES,
    learning_rate=4.0,
    final_learning_rate_share=0.0,
    n_training_iterations=N_VIEWS,
    iterations_per_episode=1,
    sensor_noise=(7.0,),
)
FOCUS_D, VERGENCE_DEG = (0.0, 0.25, 0.5, 1.0, 2.0), (0.1, 0.5, 1.5)


class Eyes:
    """Eyes before stimuli on a plane, set to errors of vergence and of focus."""

    def __init__(self, scales: ScalesConfig = SCALES) -> None:
        stimuli = load_stimuli(StimuliConfig(n_training=N_TRAINING, n_test=N_TEST, size_px=960))
        config = CameraConfig(plane_size_m=0.75, roi_width_px=40, roi_height_px=40)
        self._camera = StereoCamera(config, stimuli, 1.7, scales, focuses=True)
        self.draw = np.random.default_rng(1)

    def see(
        self, coder: SparseCoder, i: int, error_deg: float, errors_d: NDArray[np.float64]
    ) -> Encoding:
        """Return the code of picture i; each pixel has noise of SD 2."""
        vergence = np.radians(desired_vergence_deg(DISTANCE_M, BASELINE_M) + error_deg)
        angles = np.array([[vergence / 2.0, 0.0, 0.0]] * 2)
        places = np.array([[0.0, BASELINE_M / 2.0, 1.7], [0.0, -BASELINE_M / 2.0, 1.7]])
        none = np.zeros(2)
        focus_d = errors_d + 1.0 / DISTANCE_M
        lenses = LensState(np.zeros(4), focus_d, focus_d, np.full(2, 0.004), none, none)
        view = places, eye_rotations(angles), i, DISTANCE_M
        left, right = self._noisy(self._camera.render(*view, lenses))
        apart = [self._noisy(p) for _, p in self._camera.render_apart(*view, lenses)]
        return coder.encode(left, right, apart)

    def _noisy(self, pictures: NDArray[np.uint8]) -> NDArray[np.uint8]:
        noisy = pictures + 2.0 * self.draw.standard_normal(pictures.shape)
        return np.clip(np.rint(noisy), 0, 255).astype(np.uint8)


@pytest.fixture(scope="module")
def rewards() -> dict[tuple[float, float], NDArray[np.float64]]:
    """Return -E and I of the whitened scales, (N_TEST, 2), by errors of vergence and focus."""
    eyes, coder = _trained(SCALES)
    places = [(0.0, d) for d in FOCUS_D] + [(deg, 0.0) for deg in VERGENCE_DEG]
    return {
        (deg, d): _rewards(
            [eyes.see(coder, N_TRAINING + i, deg, np.full(2, d)) for i in range(N_TEST)]
        )
        for deg, d in places
    }


def _trained(scales: ScalesConfig) -> tuple[Eyes, SparseCoder]:
    eyes, coder = Eyes(scales), SparseCoder(replace(CODER, scales=scales))
    for k in range(N_VIEWS):
        spread = 0.1 if k % 2 else 1.0  # half of what is learned is near the right place
        error_deg, *errors_d = spread * eyes.draw.uniform(-2.0, 2.0, 3)
        coder.learn(eyes.see(coder, k % N_TRAINING, error_deg, np.array(errors_d)))
    return eyes, coder


def _rewards(codes: Sequence[Encoding]) -> NDArray[np.float64]:
    return np.array(
        [[-code.reconstruction_error[1:].sum(), code.worth_to_lenses] for code in codes]
    )


def test_information_is_largest_in_focus_and_falls_with_blur(rewards) -> None:
    means = [rewards[0.0, d][:, 1].mean() for d in FOCUS_D]
    assert means == sorted(means, reverse=True)
    better = rewards[0.0, 0.0][:, 1] > rewards[0.0, 1.0][:, 1]
    assert better.all()


def test_the_reconstruction_error_prefers_a_dioptre_of_blur(rewards) -> None:
    means = [rewards[0.0, d][:, 0].mean() for d in FOCUS_D]
    assert int(np.argmax(means)) == FOCUS_D.index(1.0)
    assert (rewards[0.0, 1.0][:, 0] > rewards[0.0, 0.0][:, 0]).mean() > 0.7


def test_both_are_best_where_the_eyes_converge(rewards) -> None:
    for i in range(2):
        means = [rewards[deg, 0.0][:, i].mean() for deg in (0.0, *VERGENCE_DEG)]
        assert int(np.argmax(means)) == 0
        assert (rewards[0.0, 0.0][:, i] > rewards[0.5, 0.0][:, i]).all()


def test_light_focused_farther_and_nearer_gives_blur_a_sign() -> None:
    scales = replace(
        SCALES, names=("fine", "far", "near"), zoom=(1.0, 4.0, 4.0), focus_d=(0.0, -0.5, 0.5)
    )
    eyes, coder = _trained(scales)
    nearer = []
    for error_d in (-0.5, 0.5):
        views = range(N_TRAINING, N_TRAINING + N_TEST)
        told = [eyes.see(coder, i, 0.0, np.full(2, error_d)).information for i in views]
        nearer.append(np.array(told) @ [-1.0, 1.0])
    # Eyes that focus too far see the light sharp that they focus nearer.
    assert nearer[0].min() > 0.0 > nearer[1].max()
