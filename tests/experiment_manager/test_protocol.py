"""The sequence of episodes: the paper's numbers, and a function of (seed, place) alone."""

import math
import re
from typing import Any

import numpy as np
import pytest

from experiment_manager import Protocol, make_protocol
from experiment_manager.config import (
    PAPER_TEST_ITERATIONS,
    ExperimentManagerConfig,
    ProtocolConfig,
)
from experiment_manager.plant_changes import Schedule
from experiment_manager.starts import PairStarts, conditions
from eye_plant import Episode
from lockstep import InputError
from lockstep.wire.topics import TEST, TRAINING
from tests.pair import pair_activations

BASELINE_M = 0.056
SMALL: dict[str, Any] = {
    "n_training_iterations": 120,
    "test_iterations": (0, 50, 9000),
    "n_training_stimuli": 5,
    "n_test_stimuli": 3,
    "n_stimuli_per_test": 2,
}


def _activations(vergence_deg: float, fraction: float) -> tuple[float, ...]:
    """Stand in for the plant's inverse: any function will do."""
    return pair_activations(vergence_deg / 100.0, fraction / 10.0)


def _protocol(seed: int = 1, **settings: Any) -> Protocol:
    return _protocol_of(ProtocolConfig(**(SMALL | settings)), seed)


def _protocol_of(config: ProtocolConfig, seed: int = 1) -> Protocol:
    return Protocol(config, seed, [PairStarts(config, BASELINE_M, _activations)], Schedule())


def _episodes(protocol: Protocol, phase: int | None = None) -> list[Episode]:
    """Return all episodes, or those of a phase."""
    episodes = map(protocol.episode, range(len(protocol)))
    return [episode for episode in episodes if phase in (None, episode.phase)]


def test_the_papers_conditions() -> None:
    found = conditions(ProtocolConfig(), BASELINE_M)
    assert len(found) == 39
    by_distance: dict[float, list[float]] = {}
    for condition in found:
        by_distance.setdefault(condition.object_distance_m, []).append(condition.start_error_deg)
    # gamma = 2 atan(0.028 / d): 6.41, 3.21, 1.60, 1.07, 0.80, 0.64, 0.53 deg.
    highest = {0.5: 6, 1.0: 3, 2.0: 1, 3.0: 1, 4.0: 0, 5.0: 0, 6.0: 0}
    assert by_distance == {d: [float(e) for e in range(-3, h + 1)] for d, h in highest.items()}


def test_the_conditions_of_the_authors_code() -> None:
    found = conditions(ProtocolConfig(start_errors="code"), BASELINE_M)
    assert len(found) == 49, "with 40 pictures 1,960 trials, 1,680 of them with an error"
    by_distance: dict[float, list[float]] = {}
    for condition in found:
        by_distance.setdefault(condition.object_distance_m, []).append(condition.start_error_deg)
    outward = [-2.0, -1.3333, -0.6667, 0.0]
    assert by_distance[1.0] == pytest.approx([*outward, 0.6667, 1.3333, 2.0], abs=1e-4)
    # At 6 m the desired vergence is 0.5348 deg.
    assert by_distance[6.0] == pytest.approx([*outward, 0.1783, 0.3565, 0.5348], abs=1e-4)


def test_the_papers_tests() -> None:
    paper = _protocol_of(ProtocolConfig())
    assert paper.n_trials == 1560
    assert paper.test_iterations == PAPER_TEST_ITERATIONS
    assert len(PAPER_TEST_ITERATIONS) == 13
    assert len(paper) == 13 * 1560 + 100_000


def test_tests_beyond_the_end_are_left_out_and_one_at_the_end_is_made() -> None:
    assert _protocol().test_iterations == (0, 50, 120)
    assert _protocol(n_training_iterations=0).test_iterations == (0,)


def test_the_plane_and_the_first_gaze_have_distances_of_their_own() -> None:
    # gamma = 2 atan(0.028 / 3) = 1.0694 deg, whatever the plane's distance.
    protocol = _protocol(object_distance_m=(1.0, 1.0), fixation_distance_m=(3.0, 3.0))
    trained = _episodes(protocol, TRAINING)
    assert {episode.object_distance_m for episode in trained} == {1.0}
    assert [episode.activations[0] for episode in trained] == pytest.approx(
        [0.010694] * 12, rel=1e-4
    )
    # Drawn from one range they are drawn apart: knowing one tells nothing of the other.
    both = _protocol(n_training_iterations=10_000, test_iterations=(10_000,))
    training = list(both.training_episodes())
    gamma_deg = [math.degrees(2 * math.atan(0.028 / e.object_distance_m)) for e in training]
    first_gaze_deg = [100.0 * e.activations[0] for e in training]
    assert abs(np.corrcoef(gamma_deg, first_gaze_deg)[0, 1]) < 0.1


def test_the_order_of_phases() -> None:
    protocol = _protocol()
    n_trials = 2 * 39
    assert protocol.n_trials == n_trials
    episodes = _episodes(protocol)
    assert len(episodes) == 3 * n_trials + 12
    phases = "".join("T" if e.phase == TEST else "-" for e in episodes)
    assert phases == "T" * n_trials + "-" * 5 + "T" * n_trials + "-" * 7 + "T" * n_trials
    trained = _episodes(protocol, TRAINING)
    assert [e.episode for e in trained] == list(range(12))
    assert [e.training_iteration for e in trained] == list(range(0, 120, 10))
    assert {(e.test, e.trial) for e in trained} == {(-1, -1)}
    tests = _episodes(protocol, TEST)
    assert [e.trial for e in tests] == 3 * list(range(n_trials))
    assert {(e.test, e.episode, e.training_iteration) for e in tests} == {
        (0, 0, 0),
        (1, 5, 50),
        (2, 12, 120),
    }


def test_the_kind_of_a_place_is_that_of_its_episode() -> None:
    protocol = _protocol()
    for place, episode in enumerate(_episodes(protocol)):
        number = episode.episode if episode.phase == TRAINING else episode.trial
        assert protocol.kind(place) == (episode.phase, number)


def test_training_iterations_before_each_place() -> None:
    protocol = _protocol()
    counted = 0
    for place, episode in enumerate(_episodes(protocol)):
        assert protocol.training_iterations_before(place) == counted == episode.training_iteration
        counted += episode.n_iterations if episode.phase == TRAINING else 0
    assert protocol.training_iterations_before(len(protocol)) == counted == 120


def test_observations_are_numbered_without_a_gap() -> None:
    expected = 0
    for episode in _episodes(_protocol()):
        assert episode.first_observation == expected
        assert episode.n_iterations == (20 if episode.phase == TEST else 10)
        expected += episode.n_iterations + 1


def test_trials_are_the_same_in_each_test_but_for_their_numbers() -> None:
    protocol = _protocol()
    firsts = [segment.first for segment in protocol.segments if segment.i_test >= 0]
    for trial in range(protocol.n_trials):
        shown = {
            (e.stimulus, e.object_distance_m, e.activations[0], e.activations[1])
            for e in (protocol.episode(first + trial) for first in firsts)
        }
        assert len(shown) == 1


def test_trials_cover_stimuli_times_conditions() -> None:
    protocol = _protocol()
    trials = [protocol.episode(place) for place in range(protocol.n_trials)]
    starts = {(e.stimulus, e.object_distance_m, round(e.activations[0], 9)) for e in trials}
    assert len(starts) == 2 * 39
    # Test stimuli are counted behind the 5 training stimuli.
    assert {e.stimulus for e in trials} == {5, 6}


def test_trials_start_with_the_error_of_their_condition() -> None:
    protocol = _protocol()
    for trial, condition in enumerate(protocol.conditions):
        episode = protocol.episode(trial)
        desired_deg = {0.5: 6.410, 1.0: 3.208, 2.0: 1.604, 3.0: 1.070, 4.0: 0.802, 5.0: 0.642}
        wanted = desired_deg.get(condition.object_distance_m, 0.535)
        assert episode.activations[0] * 100.0 == pytest.approx(
            wanted - condition.start_error_deg, abs=1e-3
        )


def test_training_draws_stay_in_their_ranges_and_differ() -> None:
    protocol = _protocol(n_training_iterations=5000, test_iterations=(0,))
    first = protocol.n_trials
    drawn = [protocol.episode(first + i) for i in range(500)]
    distances_m = [e.object_distance_m for e in drawn]
    assert 0.5 <= min(distances_m) < 0.6
    assert 5.9 < max(distances_m) <= 6.0
    assert {e.stimulus for e in drawn} == {0, 1, 2, 3, 4}
    assert len({(e.object_distance_m, e.activations[0], e.activations[1]) for e in drawn}) == 500


def test_vergence_drawn_evenly_is_as_often_near_as_far() -> None:
    protocol = _protocol(
        n_training_iterations=20_000, test_iterations=(0,), draws_vergence_evenly=True
    )
    drawn = [protocol.episode(protocol.n_trials + i) for i in range(2000)]
    distances_m = [e.object_distance_m for e in drawn]
    # By K17 eq. 6, 6.410 deg at 0.5 m and 0.535 deg at 6 m; their mean, 3.472 deg, is at 0.924 m.
    assert 0.5 <= min(distances_m) < 0.51
    assert 5.5 < max(distances_m) <= 6.0
    assert np.median(distances_m) == pytest.approx(0.924, rel=0.05)
    # The stand-in for the inverse tells the vergence that was asked for.
    vergence_deg = np.array([100.0 * e.activations[0] for e in drawn])
    assert np.histogram(vergence_deg, bins=4, range=(0.535, 6.410))[0].tolist() == pytest.approx(
        [500] * 4, rel=0.12
    )


def test_an_episode_is_a_function_of_seed_and_place() -> None:
    places = [0, 77, 78, 82, 90, 170]
    ahead, other = _protocol(), _protocol()
    expected = {place: ahead.episode(place) for place in places}
    assert {place: other.episode(place) for place in reversed(places)} == expected
    different = _protocol(seed=2)
    assert all(different.episode(place) != expected[place] for place in places)


def test_more_tests_do_not_change_what_is_trained() -> None:
    few, many = _protocol(test_iterations=(0,)), _protocol(test_iterations=(0, 10, 20, 30, 110))

    def trained(protocol: Protocol) -> list[tuple[object, ...]]:
        return [
            (e.episode, e.stimulus, e.object_distance_m, e.activations[0], e.activations[1])
            for e in _episodes(protocol, TRAINING)
        ]

    assert trained(few) == trained(many)


@pytest.mark.parametrize("place", [-1, 246, 10**9])
def test_places_beyond_the_ends(place: int) -> None:
    protocol = _protocol()
    assert len(protocol) == 246
    with pytest.raises(IndexError, match=f"episode {place} of 246"):
        protocol.episode(place)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"n_training_iterations": 15}, "n_training_iterations: expected a multiple of 10"),
        ({"test_iterations": (5,)}, "test_iterations: expected multiples of 10, got [5]"),
        ({"n_stimuli_per_test": 4}, "n_stimuli_per_test: expected 3 or less, got 4"),
        ({"object_distance_m": (2.0, 1.0)}, "object_distance_m: expected [lowest, highest]"),
    ],
)
def test_numbers_that_make_no_experiment(settings: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=re.escape(message)):
        ProtocolConfig(**(SMALL | settings))


def test_the_trials_that_are_left() -> None:
    config = ExperimentManagerConfig(
        n_training_iterations=20, test_iterations=(0,), n_stimuli_per_test=1, n_test_stimuli=1
    )
    protocol = make_protocol(config)
    # 39 trials, two training episodes, 39 trials.
    assert [protocol.trials_from(place) for place in (0, 1, 39, 41, 42, 80)] == [
        *(78, 77, 39, 39, 38, 0)
    ]
