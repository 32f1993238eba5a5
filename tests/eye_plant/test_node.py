"""The node eye_plant among others: what it sends, what it accepts, and what it refuses."""

import itertools
import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import CameraInfo, Image, JointState

from eye_plant.config import EyePlantConfig
from eye_plant.episode import Episode
from eye_plant.mechanics.model import MechanicsConfig
from eye_plant.mechanics.oculomotor import Oculomotor
from eye_plant.node import EyePlantNode
from eye_plant.plant import EyePlant
from eye_plant.stimuli.stimulus_set import StimuliConfig
from lockstep.errors import InputError
from lockstep.wire.stamps import period_ns, to_ns
from lockstep.wire.topics import (
    EPISODE_NAMES,
    EYE_STATE_NAMES,
    GROUND_TRUTH_NAMES,
    MEAN_METABOLIC_RATES,
    PICTURES,
    PLANT_VECTORS,
    TRAINING,
)
from lockstep.wire.vectors import vector_message
from tests.node_harness import Bench, Graph, ros_graph

PERIOD_NS = period_ns(MechanicsConfig().period_s)
HEARD = {
    **dict.fromkeys((*PLANT_VECTORS, MEAN_METABOLIC_RATES), JointState),
    **dict.fromkeys(PICTURES, Image),
}
EPISODE = Episode(
    phase=TRAINING,
    test=-1,
    trial=-1,
    episode=4,
    training_iteration=40,
    stimulus=1,
    object_distance_m=1.5,
    medial_rectus=0.05,
    lateral_rectus=0.02,
    n_iterations=3,
    first_observation=44,
)
COMMANDS = ([0.06, 0.01], [0.03, 0.02], [0.0, 0.0])


@pytest.fixture
def graph() -> Iterator[Graph]:
    """Yield a domain of the test's own."""
    with ros_graph() as graph:
        yield graph


@pytest.fixture
def bench(graph: Graph, pictures: Path) -> Bench:
    """Return a plant with small stimuli whose run has started."""
    plant = graph.add(EyePlantNode, stimuli__directory=str(pictures), stimuli__size_px=64)
    bench = Bench(graph, plant, {"muscle_command": JointState}, HEARD)
    assert bench.request("start_run") == (True, "")
    return bench


@pytest.fixture(scope="module")
def shared(pictures: Path) -> Iterator[Bench]:
    """Yield one plant for all the things that it refuses: none of them may leave a trace."""
    with ros_graph() as graph:
        plant = graph.add(EyePlantNode, stimuli__directory=str(pictures), stimuli__size_px=64)
        bench = Bench(graph, plant, {"muscle_command": JointState}, HEARD)
        assert bench.request("start_run") == (True, "")
        yield bench


_bases = itertools.count(1000, 1000)


def _begin(bench: Bench, **changes: Any) -> tuple[bool, str]:
    return bench.request("episode", **(EPISODE.as_arguments() | changes))


def _command(
    bench: Bench,
    observation: int,
    values: Any = (0.05, 0.05),
    names: Any = ("medial_rectus", "lateral_rectus"),
) -> None:
    bench.outsider.send("muscle_command", vector_message(observation * PERIOD_NS, names, values))


def _numbers(bench: Bench, topic: str) -> list[int]:
    """Return the observation numbers of what was heard on a topic."""
    return [stamp_ns // PERIOD_NS for stamp_ns in bench.outsider.stamps_ns(topic)]


def _distinct_numbers(bench: Bench, topic: str) -> list[int]:
    return list(dict.fromkeys(_numbers(bench, topic)))


def _run_episode(bench: Bench) -> None:
    assert _begin(bench) == (True, "")
    for i, command in enumerate(COMMANDS):
        bench.wait_distinct("eye_states", i + 1)
        _command(bench, 44 + i, command)
    for topic in HEARD:
        bench.wait_distinct(topic, 3 if topic in PICTURES else 4)


def test_an_episode_from_request_to_its_last_observation(bench: Bench) -> None:
    _run_episode(bench)
    for topic in PLANT_VECTORS:
        assert _distinct_numbers(bench, topic) == [44, 45, 46, 47]
    for topic in PICTURES:
        # The last observation has no pictures: nobody is to answer it.
        assert _distinct_numbers(bench, topic) == [44, 45, 46]
    for i, message in enumerate(bench.outsider.distinct("episode")):
        assert tuple(message.name) == EPISODE_NAMES
        assert list(message.position) == [0.0, -1.0, -1.0, 4.0, i, 40.0 + i, 44.0 + i]


def test_what_is_published_is_what_the_plant_computes(bench: Bench, pictures: Path) -> None:
    _run_episode(bench)
    stimuli = StimuliConfig(directory=str(pictures), size_px=64)
    plant = EyePlant(EyePlantConfig(stimuli=stimuli))
    observation = plant.begin(EPISODE)
    for i in range(4):
        heard = {
            topic: bench.outsider.distinct(topic)[i] for topic in HEARD if topic not in PICTURES
        }
        state = observation.state
        truth = heard["ground_truth"]
        assert tuple(truth.name) == GROUND_TRUTH_NAMES
        assert tuple(truth.position) == observation.ground_truth_values()
        names = plant.oculomotor.muscle_names
        assert tuple(heard["muscle_states"].name) == names
        assert tuple(heard["muscle_activations"].name) == names
        assert tuple(heard["eye_states"].name) == EYE_STATE_NAMES
        for got, expected in (
            (heard["muscle_activations"].position, state.activations),
            (heard["muscle_activations"].effort, state.metabolic_rate_w),
            (heard["muscle_states"].position, state.lengths_m),
            (heard[MEAN_METABOLIC_RATES].position, state.mean_metabolic_rate_w),
            (heard["muscle_states"].velocity, state.velocities_m_s),
            (heard["muscle_states"].effort, state.forces_n),
            (heard["eye_states"].position, state.eye_angles_rad.ravel()),
            (heard["eye_states"].velocity, state.eye_velocities_rad_s.ravel()),
        ):
            assert list(got) == expected.tolist()
        assert not heard["muscle_activations"].velocity
        if i < 3:
            assert observation.pictures is not None
            for topic, picture in zip(PICTURES, observation.pictures, strict=True):
                message = bench.outsider.distinct(topic)[i]
                assert (message.height, message.width, message.step) == (240, 320, 320)
                assert message.encoding == "mono8"
                assert message.header.frame_id == topic.replace("/image_raw", "_eye")
                assert bytes(message.data) == picture.tobytes()
            observation = plant.execute(
                plant.targets(("medial_rectus", "lateral_rectus"), np.array(COMMANDS[i]))
            )
    plant.close()


def test_simulated_time_and_camera_infos(graph: Graph, bench: Bench) -> None:
    clocks: list[Clock] = []
    infos: list[CameraInfo] = []
    bench.outsider.create_subscription(Clock, "/clock", clocks.append, 10)
    bench.outsider.create_subscription(CameraInfo, "right/camera_info", infos.append, 10)
    graph.spin_until(
        lambda: bench.node.count_subscribers("right/camera_info"), "a reader of camera infos"
    )
    _begin(bench)
    # The first observation is repeated until the newcomers are there to hear it.
    graph.spin_until(lambda: clocks and infos, "a clock and a camera info")
    assert to_ns(clocks[-1].clock) == to_ns(infos[-1].header.stamp) == 44 * PERIOD_NS
    assert infos[-1].header.frame_id == "right_eye"
    # Tx = -F b of the right eye.
    assert infos[-1].p[3] == pytest.approx(-257.34 * 0.056)


def test_a_waiting_plant_repeats_its_observation_bit_for_bit(graph: Graph, bench: Bench) -> None:
    _begin(bench)
    heard = bench.wait_heard("ground_truth", 3)
    assert heard[0] == heard[1] == heard[2]
    left = bench.wait_heard("left/image_raw", 3)
    assert left[0] == left[1] == left[2]
    # A node that starts late hears it too.
    late: list[JointState] = []
    bench.outsider.create_subscription(JointState, "episode", late.append, 10)
    graph.spin_until(lambda: late, "the repeat for a late joiner")
    assert late[0] == bench.outsider.heard["episode"][0]


def test_the_last_observation_is_repeated_until_the_next_episode(bench: Bench) -> None:
    _run_episode(bench)
    bench.graph.spin_until(lambda: _numbers(bench, "ground_truth").count(47) > 2, "two repeats")
    last = [m for m in bench.outsider.heard["ground_truth"] if to_ns(m.header.stamp) >= 47]
    assert last[-1] == last[-2] == last[-3]
    _begin(bench, first_observation=48)
    bench.wait_distinct("left/image_raw", 4)
    assert _distinct_numbers(bench, "left/image_raw") == [44, 45, 46, 48]


def test_an_episode_starts_from_nothing(bench: Bench) -> None:
    _begin(bench)
    first = bench.wait_heard("muscle_states", 1)[0]
    _command(bench, 44, (0.2, 0.0))
    bench.wait_heard("muscle_states", 2)
    _begin(bench, first_observation=60)
    heard = bench.outsider.heard["muscle_states"]
    bench.graph.spin_until(lambda: 60 in _numbers(bench, "muscle_states"), "the next episode")
    again = heard[_numbers(bench, "muscle_states").index(60)]
    assert (again.position, again.velocity, again.effort) == (
        first.position,
        first.velocity,
        first.effort,
    )


def test_a_repeated_request_is_acknowledged_and_does_not_begin_again(bench: Bench) -> None:
    _begin(bench)
    bench.wait_heard("episode", 1)
    _command(bench, 44)
    bench.graph.spin_until(lambda: 45 in _numbers(bench, "episode"), "the answer")
    assert _begin(bench) == (True, "")
    # A second start would bring observation 44 again before the answer to 45.
    _command(bench, 45)
    bench.graph.spin_until(lambda: 46 in _numbers(bench, "episode"), "the next answer")
    numbers = _numbers(bench, "episode")
    assert numbers == sorted(numbers)


def test_older_and_repeated_commands_move_nothing(bench: Bench) -> None:
    _begin(bench)
    bench.wait_heard("episode", 1)
    _command(bench, 44)
    bench.graph.spin_until(lambda: 45 in _numbers(bench, "ground_truth"), "observation 45")
    for _ in range(3):
        _command(bench, 44, (0.2, 0.0))
        _command(bench, 3, (0.2, 0.0))
    _command(bench, 45)
    bench.graph.spin_until(lambda: 46 in _numbers(bench, "ground_truth"), "observation 46")
    assert 47 not in _numbers(bench, "ground_truth")
    assert bench.node.diagnostics.n_refused == 0


def test_commands_outside_an_episode_move_nothing(bench: Bench) -> None:
    _command(bench, 0)
    _run_episode(bench)
    for observation in (46, 47):
        _command(bench, observation)
    assert _begin(bench, first_observation=48) == (True, "")
    bench.wait_distinct("ground_truth", 5)
    assert bench.node.diagnostics.n_refused == 0
    assert max(_numbers(bench, "ground_truth")) == 48


@pytest.mark.parametrize(
    ("names", "reason"),
    [
        (("medial_rectus",) * 2, "expected each muscle once, got 'medial_rectus' again"),
        (("medial_rectus", "left_medial_rectus"), "got 'left_medial_rectus' again"),
        (("medial_rectus", "tongue"), "unknown muscle 'tongue', expected some of left_"),
        (("medial_rectus",), "expected one position per name, got 2 for 1 names"),
        ((), "expected one position per name, got 2 for 0 names"),
    ],
)
def test_commands_with_wrong_names_are_refused(
    shared: Bench, names: tuple[str, ...], reason: str
) -> None:
    _refuses(shared, lambda n: _command(shared, n, (0.1, 0.1), names), reason)


@pytest.mark.parametrize(
    ("values", "reason"),
    [
        ((math.nan, 0.1), "expected finite values, got position [nan, 0.1]"),
        ((math.inf, 0.1), "expected finite values, got position [inf, 0.1]"),
        ((-0.01, 0.1), "expected activations in [0, 1], got [-0.01, 0.1]"),
        ((0.1, 1.01), "expected activations in [0, 1], got [0.1, 1.01]"),
        ((0.1,), "expected one position per name, got 1 for 2 names"),
        ((), "expected one position per name, got 0 for 2 names"),
    ],
)
def test_commands_with_wrong_values_are_refused(
    shared: Bench, values: tuple[float, ...], reason: str
) -> None:
    _refuses(shared, lambda n: _command(shared, n, values), reason)


def test_a_command_for_the_future_is_refused(shared: Bench) -> None:
    _refuses(shared, lambda n: _command(shared, n + 1), "expected the stamp of the observation it")


def _refuses(bench: Bench, send: Callable[[int], None], reason: str) -> None:
    """Check that what is sent during the first observation is refused once and changes nothing."""
    first = next(_bases)
    n_refused = bench.node.diagnostics.n_refused
    _begin(bench, first_observation=first)
    bench.graph.spin_until(lambda: first in _numbers(bench, "ground_truth"), "the episode")
    send(first)
    assert reason in bench.wait_refused(n_refused + 1)
    assert max(_numbers(bench, "ground_truth")) == first
    _command(bench, first, COMMANDS[0])
    bench.graph.spin_until(lambda: first + 1 in _numbers(bench, "ground_truth"), "the answer")
    truth = bench.outsider.heard["ground_truth"][_numbers(bench, "ground_truth").index(first + 1)]
    assert truth.position[GROUND_TRUTH_NAMES.index("vergence_deg")] == (
        _vergence_after_first_command()
    )


def _vergence_after_first_command() -> float:
    oculomotor = Oculomotor(MechanicsConfig())
    oculomotor.settle(oculomotor.activations_from(EPISODE.medial_rectus, EPISODE.lateral_rectus))
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
        ({"medial_rectus": 1.5}, "medial_rectus: expected 0 to 1, got 1.5"),
        ({"lateral_rectus": math.nan}, "lateral_rectus: expected 0 to 1, got nan"),
        ({"n_iterations": 0}, "n_iterations: expected 1 or more, got 0"),
        ({"first_observation": -1}, "first_observation: expected 0 or more, got -1"),
        ({"first_observation": 2**62}, "expected stamps below 2^31 s"),
        ({"n_iterations": 2**62}, "expected stamps below 2^31 s"),
        ({"weather": 1}, "missing: none, unknown: weather"),
    ],
)
def test_episodes_that_cannot_be_are_refused(
    shared: Bench, changes: dict[str, Any], reason: str
) -> None:
    first = next(_bases)
    n_refused = shared.node.diagnostics.n_refused
    successful, got = _begin(shared, **({"first_observation": first} | changes))
    assert not successful
    assert reason in got
    assert reason in shared.wait_refused(n_refused + 1)
    assert max(_numbers(shared, "episode"), default=0) < first
    assert _begin(shared, first_observation=first) == (True, "")
    shared.graph.spin_until(lambda: first in _numbers(shared, "episode"), "the episode")


def test_an_episode_with_missing_arguments_is_refused(bench: Bench) -> None:
    assert "missing: episode, first_observation" in bench.request("episode", phase=0)[1]


def test_a_refused_episode_leaves_the_one_under_way_alone(bench: Bench) -> None:
    _begin(bench)
    bench.wait_heard("episode", 1)
    assert not _begin(bench, stimulus=99, first_observation=90)[0]
    _command(bench, 44)
    bench.graph.spin_until(lambda: 45 in _numbers(bench, "episode"), "observation 45")


def test_another_runs_episode_is_refused(bench: Bench) -> None:
    refusal = f"expected a request of run {bench.RUN}, got one of run somebody_elses"
    assert _begin(bench, run_id="somebody_elses") == (False, refusal)
    assert bench.outsider.heard["episode"] == []


def test_after_the_end_of_a_run_the_plant_is_silent(bench: Bench) -> None:
    _begin(bench)
    bench.wait_heard("episode", 1)
    assert bench.request("end_run") == (True, "")
    n_heard = len(bench.outsider.heard["episode"])
    # The next statuses come a second apart each, as repeats would.
    bench.next_status()
    assert len(bench.outsider.heard["episode"]) == n_heard
    assert bench.outsider.status["state"] == "waiting for an episode"


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        (
            "camera__width_px",
            321,
            "camera.width_px: expected a multiple of 2, 2 px or more, got 321",
        ),
        ("camera__width_px", "wide", "camera.width_px: expected an integer, got 'wide'"),
        ("mechanics__parameter_set", "k99", "mechanics.parameter_set: expected k17 or anatomical"),
        ("stimuli__directory", "/nowhere", "stimuli.directory: expected a directory of pictures"),
        ("camera__with_px", 320, "unknown parameter camera.with_px"),
    ],
)
def test_a_configuration_that_cannot_be_met(
    graph: Graph, name: str, value: Any, message: str
) -> None:
    with pytest.raises(InputError) as error:
        graph.add(EyePlantNode, **{name: value})
    assert message in str(error.value)
