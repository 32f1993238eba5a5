"""What the node eye_plant refuses, and that it leaves no trace."""

import itertools
import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from eye_plant.mechanics.mujoco_model import MechanicsConfig
from eye_plant.mechanics.oculomotor import Oculomotor
from lockstep.wire.topics import GROUND_TRUTH_NAMES
from tests.eye_plant.plant_bench import (
    COMMANDS,
    EPISODE,
    begin,
    observation_numbers,
    plant_bench,
    send_command,
    wait_for,
)
from tests.node_harness import Bench, ros_graph


@pytest.fixture(scope="module")
def shared(pictures: Path) -> Iterator[Bench]:
    """Yield one plant for all the things that it refuses: none of them may leave a trace."""
    with ros_graph() as graph:
        bench = plant_bench(graph, pictures)
        assert bench.request("start_run") == (True, "")
        yield bench


_bases = itertools.count(1000, 1000)


RECTI = ("medial_rectus", "lateral_rectus")


@pytest.mark.parametrize(
    ("names", "values", "reason"),
    [
        (
            ("medial_rectus",) * 2,
            (0.1, 0.1),
            "expected each muscle once, got 'medial_rectus' again",
        ),
        (("medial_rectus", "left_medial_rectus"), (0.1, 0.1), "got 'left_medial_rectus' again"),
        (
            ("medial_rectus", "tongue"),
            (0.1, 0.1),
            "unknown muscle 'tongue', expected some of left_",
        ),
        ((), (0.1, 0.1), "expected one position per name, got 2 for 0 names"),
        (RECTI, (0.1,), "expected one position per name, got 1 for 2 names"),
        (RECTI, (math.nan, 0.1), "expected finite values, got medial_rectus nan"),
        (RECTI, (math.inf, 0.1), "expected finite values, got medial_rectus inf"),
        (RECTI, (-0.01, 0.1), "expected activations in [0, 1], got [-0.01, 0.1]"),
        (RECTI, (0.1, 1.01), "expected activations in [0, 1], got [0.1, 1.01]"),
    ],
)
def test_commands_with_wrong_names_or_values_are_refused(shared, names, values, reason) -> None:
    _refuses(shared, lambda n: send_command(shared, n, values, names), reason)


def test_a_command_for_the_future_is_refused(shared: Bench) -> None:
    _refuses(
        shared, lambda n: send_command(shared, n + 1), "expected the stamp of the observation it"
    )


def test_other_eyes_amid_an_episode_are_refused(shared: Bench) -> None:
    settings: dict[str, Any] = {"mechanics.rest_adduction_deg": [0.0, 5.0]}

    def ask(first: int) -> None:
        assert not shared.request("reconfigure", **settings)[0]

    _refuses(shared, ask, "reconfigure: expected between episodes, got during one, at observation")


def _refuses(bench: Bench, send: Callable[[int], None], reason: str) -> None:
    """Check that what is sent during the first observation is refused once and changes nothing."""
    first = next(_bases)
    n_refused = bench.node.diagnostics.n_refused
    begin(bench, first_observation=first)
    wait_for(bench, first)
    send(first)
    assert reason in bench.wait_refused(n_refused + 1)
    assert max(observation_numbers(bench, "ground_truth")) == first
    send_command(bench, first, COMMANDS[0])
    wait_for(bench, first + 1)
    truth = bench.outsider.heard["ground_truth"][
        observation_numbers(bench, "ground_truth").index(first + 1)
    ]
    assert truth.position[GROUND_TRUTH_NAMES.index("vergence_deg")] == (
        _vergence_after_first_command()
    )


def _vergence_after_first_command() -> float:
    oculomotor = Oculomotor(MechanicsConfig())
    oculomotor.settle(np.array(EPISODE.activations))
    oculomotor.step(oculomotor.activations_from(*COMMANDS[0]))
    return float(np.degrees(oculomotor.state().eye_angles_rad[:, 0].sum()))


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"phase": 2}, "phase: expected 0 to 1, got 2"),
        ({"phase": "0"}, "phase: expected an integer, got '0'"),
        ({"stimulus": 5}, "stimulus: expected 0 to 4, got 5"),
        ({"stimulus": -1}, "stimulus: expected 0 or more, got -1"),
        ({"object_distance_m": 0.0}, "object_distance_m: expected more than 0 m, got 0.0"),
        ({"object_distance_m": math.nan}, "object_distance_m: expected more than 0 m, got nan"),
        ({"object_distance_m": 1e9}, "object_distance_m: expected"),
        ({"object_distance_m": 1e-9}, "object_distance_m: expected"),
        ({"activations": [1.5] * 12}, "activations: expected 0 to 1, got [1.5,"),
        ({"activations": [math.nan] * 12}, "activations: expected 0 to 1, got [nan,"),
        ({"activations": [0.1] * 6}, "activations: expected those of 12 muscles, or joints_rad,"),
        ({"joints_rad": [0.1]}, "got 12 activations and 1 angles"),
        ({"n_iterations": 0}, "n_iterations: expected 1 or more, got 0"),
        ({"first_observation": -1}, "first_observation: expected 0 or more, got -1"),
        ({"first_observation": 2**62}, "expected stamps below 2^31 s"),
        ({"n_iterations": 2**62}, "expected stamps below 2^31 s"),
        ({"weather": 1}, "missing: none, unknown: weather"),
    ],
)
def test_episodes_that_cannot_be_are_refused(shared, changes, reason) -> None:
    first = next(_bases)
    n_refused = shared.node.diagnostics.n_refused
    successful, got = begin(shared, **({"first_observation": first} | changes))
    assert not successful
    assert reason in got
    assert reason in shared.wait_refused(n_refused + 1)
    assert max(observation_numbers(shared, "episode"), default=0) < first
    assert begin(shared, first_observation=first) == (True, "")
    wait_for(shared, first, "episode")


def test_an_episode_with_missing_arguments_is_refused(bench: Bench) -> None:
    assert "missing: episode, first_observation" in bench.request("episode", phase=0)[1]


@pytest.mark.parametrize("changes", [{"stimulus": 99}, {"activations": [], "joints_rad": [0.1]}])
def test_a_refused_episode_leaves_the_one_under_way_alone(bench: Bench, changes) -> None:
    begin(bench)
    bench.wait_heard("episode", 1)
    assert not begin(bench, first_observation=90, **changes)[0]
    send_command(bench, 44)
    wait_for(bench, 45, "episode")
