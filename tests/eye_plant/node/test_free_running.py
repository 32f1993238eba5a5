"""The plant at a fixed rate: it waits for no node, and a command acts on arrival."""

from pathlib import Path

import numpy as np
import pytest

from eye_plant.config import FreeRunningConfig
from lockstep import InputError
from lockstep.wire.topics import EYE_STATE_NAMES
from lockstep.wire.vectors import vector_message
from tests.eye_plant.plant_bench import begin, plant_bench
from tests.node_harness import Bench, Graph

PERIOD_NS = 20_000_000
_LEFT_ADDUCTION = EYE_STATE_NAMES.index("left_adduction")


@pytest.fixture
def bench(graph: Graph, pictures: Path) -> Bench:
    """Return a free-running plant."""
    return plant_bench(graph, pictures, free_running__rate_hz=1e9 / PERIOD_NS)


def test_observations_follow_each_other_without_any_command(bench: Bench) -> None:
    bench.wait_heard("left/image_raw", 5)
    steps_ns = np.diff(bench.outsider.stamps_ns("ground_truth"))
    assert (steps_ns == PERIOD_NS).all()


def test_a_command_turns_the_eyes_whatever_its_stamp(bench: Bench) -> None:
    bench.wait_heard("eye_states", 2)
    before_rad = bench.outsider.heard["eye_states"][-1].position[_LEFT_ADDUCTION]
    bench.outsider.send("muscle_command", vector_message(0, ["medial_rectus"], [0.1]))
    bench.graph.spin_until(
        lambda: (
            bench.outsider.heard["eye_states"][-1].position[_LEFT_ADDUCTION]
            > before_rad + np.radians(2.0)
        ),
        "adduction by a medial rectus of 0.1",
    )


def test_a_bad_command_is_refused_and_the_plant_goes_on(bench: Bench) -> None:
    bench.outsider.send("muscle_command", vector_message(0, ["medial_rectus"], [1.5]))
    status = bench.next_status()
    while status["refused_inputs"] == "0":
        status = bench.next_status()
    assert "expected activations in [0, 1], got [1.5]" in status["last_refused"]
    assert status["state"] == "free running"
    n_heard = len(bench.outsider.heard["episode"])
    bench.wait_heard("episode", n_heard + 2)


def test_an_episode_beyond_all_stamps_is_refused_and_the_plant_goes_on(bench: Bench) -> None:
    bench.wait_heard("episode", 1)
    assert bench.request("start_run") == (True, "")
    is_taken, reason = begin(bench, first_observation=2**62)
    assert not is_taken
    assert "expected stamps below 2^31 s" in reason
    n_heard = len(bench.outsider.heard["episode"])
    bench.wait_heard("episode", n_heard + 2)


@pytest.mark.parametrize("rate_hz", [-1.0, float("nan"), 1e6])
def test_a_rate_that_is_none_is_refused(rate_hz: float) -> None:
    with pytest.raises(InputError, match="rate_hz: expected 0 to 1000 Hz"):
        FreeRunningConfig(rate_hz=rate_hz)
