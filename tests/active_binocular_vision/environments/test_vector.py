"""The environment for agents with their usual settings: one vector, and what an action improved."""

from collections.abc import Callable
from pathlib import Path

import gymnasium
import numpy as np
import pytest

import active_binocular_vision.environments  # noqa: F401 (registers them)
from experiment_manager.run import checkpoint
from lockstep import InputError, read_state
from tests.conftest import STIMULUS_PX

ID = "active_binocular_vision/Vergence-v0"


def test_an_observation_is_normalised_as_in_training_and_a_reward_is_an_improvement(
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
        "ActiveVergenceFeatures-v0",
        profile="precise",
        settings=settings,
        coder_state=found[1] / "sparse_coder.npz",
        coder_learns=False,
        action_scale=1 / 32,
    )
    state = read_state(found[1] / "vergence_rl.npz", "vergence_rl")
    scale = np.sqrt(state["statistics_squared_deviation"] / (state["statistics_count"] - 1))
    observed, info = environment.reset(seed=3)
    expected, before = own.reset(seed=3)
    for action in ([0.5, -0.5], [1.0, 0.25]):
        entries = np.append(np.sqrt(expected["features"].ravel()), expected["activations"])
        with np.errstate(divide="ignore", invalid="ignore"):
            normal = np.nan_to_num((entries - state["statistics_mean"]) / scale, posinf=0, neginf=0)
        assert observed.dtype == np.float32
        assert np.allclose(observed, normal, rtol=1e-5, atol=1e-5)
        observed, reward, *_ = environment.step(action)
        expected, absolute, _, _, info = own.step(action)
        assert reward == pytest.approx(30 * (absolute - before["reward"]))
        before = info
    environment.close()
    own.close()


def test_eyes_without_a_checkpoint_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="eyes: expected a run with a checkpoint, or a name"):
        gymnasium.make(ID, eyes=tmp_path)
