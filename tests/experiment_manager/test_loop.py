"""The loop in one process by itself; integration/test_graph.py holds the graph against it."""

import dataclasses
from typing import Any

import numpy as np
import pytest

from experiment_manager.loop import make_loop
from eye_plant import Episode, StimulusSet
from lockstep.wire.topics import TRAINING
from tests.pair import pair_activations


def learned(eye_plant: dict[str, Any]) -> tuple[list[tuple[int, ...]], dict[str, np.ndarray]]:
    """Return the sizes of the pictures, and all that three episodes have taught."""
    noise = np.random.default_rng(0).integers(0, 256, (2, 400, 400), np.uint8)
    loop = make_loop(
        {"eye_plant": eye_plant, "sparse_coder": {}, "vergence_rl": {}},
        StimulusSet(tuple(noise[:1]), tuple(noise[1:])),
    )
    sizes = []
    for number, distance_m in enumerate((0.5, 2.0, 6.0)):
        episode = dataclasses.replace(
            Episode.alone(0, distance_m, pair_activations(0.05, 0.02), n_iterations=5),
            phase=TRAINING,
            episode=number,
            training_iteration=5 * number,
            first_observation=6 * number,
        )
        for step in loop.run_episode(episode):
            if step.observation.pictures is not None:
                sizes.append(step.observation.pictures.shape)
    loop.plant.close()
    return sizes, loop.coder.state() | {f"agent {k}": v for k, v in loop.agent.state().items()}


@pytest.mark.parametrize("side_px", [128, 160])
def test_a_region_of_interest_changes_no_learned_number(side_px: int) -> None:
    sizes, whole = learned({})
    sizes_of_region, of_region = learned(
        {"camera.roi_width_px": side_px, "camera.roi_height_px": side_px}
    )
    assert set(sizes) == {(2, 240, 320)}
    assert set(sizes_of_region) == {(2, side_px, side_px)}
    assert whole.keys() == of_region.keys()
    for name, values in whole.items():
        assert values.tobytes() == of_region[name].tobytes(), name
