"""The environment for agents with their usual settings: one vector, and a reward for each place."""

from collections.abc import Callable
from pathlib import Path

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import active_binocular_vision.environments  # noqa: F401 (registers them)
from experiment_manager.run import checkpoint
from lockstep import InputError, read_state
from sparse_coder import SparseCoder, SparseCoderConfig
from tests.conftest import STIMULUS_PX

ID = "active_binocular_vision/Vergence-v0"


def test_an_observation_is_normalised_as_in_training_and_a_reward_is_the_excess_of_e(
    run_of: Callable[[str], Path], pictures: Path
) -> None:
    run = run_of("pair")
    settings = {
        "eye_plant.stimuli.directory": str(pictures),
        "eye_plant.stimuli.size_px": STIMULUS_PX,
        "task.n_bases": 32,
    }
    found = checkpoint.newest(run / "checkpoints")
    assert found is not None
    environment = gymnasium.make(ID, eyes=run, settings=settings)
    own = gymnasium.make(
        "ActiveVergence-v0",
        profile="precise",
        settings=settings,
        coder_state=found[1] / "sparse_coder.npz",
        coder_learns=False,
        action_scale=1 / 128,
    )
    state = read_state(found[1] / "vergence_rl.npz", "vergence_rl")
    scale = np.sqrt(state["statistics_squared_deviation"] / (state["statistics_count"] - 1))
    coder = SparseCoder(SparseCoderConfig(n_bases=32))
    coder.restore(read_state(found[1] / "sparse_coder.npz", "sparse_coder"))
    observed, begun = environment.reset(seed=3)
    expected, _ = own.reset(seed=3)
    left, right = expected["pictures"]
    both, one = (coder.encode(left, other).reconstruction_error for other in (right, left))
    assert begun["reward"] == pytest.approx(-10 * (both - one).sum())
    for action in ([0.5, -0.5], [1.0, 0.25]):
        features = coder.encode(*expected["pictures"]).features
        entries = np.append(np.sqrt(features.ravel()), expected["activations"])
        with np.errstate(divide="ignore", invalid="ignore"):
            normal = np.nan_to_num((entries - state["statistics_mean"]) / scale, posinf=0, neginf=0)
        assert observed.dtype == np.float32
        assert np.allclose(observed, normal, rtol=1e-5, atol=1e-5)
        observed, reward, *_, info = environment.step(action)
        expected, *_ = own.step(action)
        left, right = expected["pictures"]
        both, one = (coder.encode(left, other).reconstruction_error for other in (right, left))
        assert info["reward"] == reward == pytest.approx(-10 * (both - one).sum())
    check_env(environment.unwrapped, skip_render_check=True)
    environment.close()
    own.close()


def test_eyes_without_a_checkpoint_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="eyes: expected a run with a checkpoint, or a name"):
        gymnasium.make(ID, eyes=tmp_path)
