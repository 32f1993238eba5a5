"""The loop in one process by itself; integration/test_graph.py holds the graph against it."""

import copy
import dataclasses
import pickle
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
import pytest

from experiment_manager.loop import InProcessLoop, Step, make_loop
from eye_plant import Episode, StimulusSet
from lockstep.wire.topics import TRAINING
from tests.own_rule import REINFORCE
from tests.pair import pair_activations


def loop_of(**configuration: dict[str, Any]) -> InProcessLoop:
    """Return an untrained loop before noise."""
    noise = np.random.default_rng(0).integers(0, 256, (2, 400, 400), np.uint8)
    stimuli = StimulusSet(tuple(noise[:1]), tuple(noise[1:]))
    return make_loop(configuration, stimuli)


def trained(loop: InProcessLoop, numbers: Iterable[int]) -> list[Step]:
    """Return the steps of training episodes at three distances."""
    steps: list[Step] = []
    for number in numbers:
        distance_m = (0.5, 2.0, 6.0)[number % 3]
        episode = dataclasses.replace(
            Episode.alone(0, distance_m, pair_activations(0.05, 0.02), n_iterations=5),
            phase=TRAINING,
            episode=number,
            training_iteration=5 * number,
            first_observation=6 * number,
        )
        steps += loop.run_episode(episode)
    return steps


def state_of(loop: InProcessLoop) -> dict[str, np.ndarray]:
    """Return all that a loop has learned."""
    return loop.coder.state() | {f"agent {k}": v for k, v in loop.agent.state().items()}


def learned(eye_plant: dict[str, Any]) -> tuple[list[tuple[int, ...]], dict[str, np.ndarray]]:
    """Return the sizes of the pictures, and all that three episodes have taught."""
    loop = loop_of(eye_plant=eye_plant)
    seen = [step.observation.pictures for step in trained(loop, range(3))]
    loop.plant.close()
    return [pictures.shape for pictures in seen if pictures is not None], state_of(loop)


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


@pytest.mark.parametrize("rule", ["cacla", "hindsight", REINFORCE])
@pytest.mark.parametrize("copied", [copy.deepcopy, lambda loop: pickle.loads(pickle.dumps(loop))])
def test_a_copy_learns_the_same(
    rule: str, copied: Callable[[InProcessLoop], InProcessLoop]
) -> None:
    loop = loop_of(vergence_rl={"learning_rule": rule})
    trained(loop, range(3))
    other = copied(loop)
    *_, last = trained(other, range(3, 6))
    *_, expected = pickle.loads(pickle.dumps(trained(loop, range(3, 6))))
    assert last.observation.truth == expected.observation.truth
    found_w, expected_w = (s.observation.state.mean_metabolic_rate_w for s in (last, expected))
    np.testing.assert_array_equal(found_w, expected_w)
    found = state_of(other)
    for name, values in state_of(loop).items():
        assert values.tobytes() == found[name].tobytes(), name


def test_lenses_are_commanded_felt_and_coded_at_a_scale_of_their_own() -> None:
    task = {
        "command_space": "pair_and_lenses",
        "highest_activations": [0.2, 0.1, 0.4, 0.4],
        "lowest_activations": [0.0],
        "n_bases": 32,
        "scales.names": ["coarse", "fine", "foveal"],
        "scales.window_px": [128, 40, 40],
        "scales.size_px": [32, 40, 40],
        "scales.zoom": [1.0, 1.0, 4.0],
        "scales.focus_d": [0.0, 0.0, 0.0],
        "scales.n_for_lenses": 1,
    }
    loop = loop_of(task=task)
    assert loop.agent.config.n_state == 3 * 32 + 4 + 1
    *_, before, last = trained(loop, range(2))
    assert before.answer is not None
    percept, command = before.answer.percept, before.answer.decision.command
    assert percept.encoding.features.shape == (3, 32)
    assert percept.reward == percept.encoding.worth_to_eyes
    assert percept.encoding.worth_to_lenses > 0.0
    assert last.observation.lenses is not None
    np.testing.assert_allclose(last.observation.lenses.accommodation_d, 12.5 * command[2:])
    assert loop.agent.learning_steps == 8
    loop.plant.close()
