"""The node eye_plant among others: what it sends, what it accepts, and what it refuses."""

from pathlib import Path

import numpy as np
import pytest
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import CameraInfo, JointState

from eye_plant import EyePlant, EyePlantConfig
from eye_plant.node.plant_node import EyePlantNode
from eye_plant.stimuli.stimulus_set import StimuliConfig
from lockstep import MUSCLE_NAMES, InputError
from lockstep.wire.topics import (
    EPISODE_NAMES,
    EYE_STATE_NAMES,
    GROUND_TRUTH_NAMES,
    MEAN_METABOLIC_RATES,
    PICTURES,
    PLANT_VECTORS,
)
from tests.eye_plant.plant_bench import (
    COMMANDS,
    EPISODE,
    HEARD,
    PERIOD_NS,
    begin,
    distinct_numbers,
    observation_numbers,
    run_episode,
    send_command,
    wait_for,
)
from tests.node_harness import Bench, Graph
from tests.stamps import to_ns


def test_an_episode_from_request_to_its_last_observation(bench: Bench) -> None:
    run_episode(bench)
    for topic in PLANT_VECTORS:
        assert distinct_numbers(bench, topic) == [44, 45, 46, 47]
    for topic in PICTURES:
        # The last observation has no pictures: nobody is to answer it.
        assert distinct_numbers(bench, topic) == [44, 45, 46]
    for i, message in enumerate(bench.outsider.distinct("episode")):
        assert tuple(message.name) == EPISODE_NAMES
        assert list(message.position) == [0.0, -1.0, -1.0, 4.0, i, 40.0 + i, 44.0 + i]


def test_what_is_published_is_what_the_plant_computes(bench: Bench, pictures: Path) -> None:
    run_episode(bench)
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
        assert tuple(heard["muscle_states"].name) == MUSCLE_NAMES
        assert tuple(heard["muscle_activations"].name) == MUSCLE_NAMES
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
    begin(bench)
    # The first observation is repeated until the newcomers are there to hear it.
    graph.spin_until(lambda: clocks and infos, "a clock and a camera info")
    assert to_ns(clocks[-1].clock) == to_ns(infos[-1].header.stamp) == 44 * PERIOD_NS
    assert infos[-1].header.frame_id == "right_eye"
    # Tx = -F b of the right eye.
    assert infos[-1].p[3] == pytest.approx(-257.34 * 0.056)


def test_a_waiting_plant_repeats_its_observation_bit_for_bit(graph: Graph, bench: Bench) -> None:
    begin(bench)
    heard = bench.wait_heard("ground_truth", 3)
    assert heard[0] == heard[1] == heard[2]
    left = bench.wait_heard("left/image_raw", 3)
    assert left[0] == left[1] == left[2]
    # A node that starts late hears it too.
    late: list[JointState] = []
    bench.outsider.create_subscription(JointState, "episode", late.append, 10)
    graph.spin_until(lambda: late, "the repeat for a late joiner")
    assert late[0] == bench.outsider.heard["episode"][0]


def test_the_state_says_whether_an_episode_is_under_way(bench: Bench) -> None:
    assert bench.next_status()["state"] == "waiting for an episode"
    assert begin(bench) == (True, "")
    assert bench.next_status()["state"] == "in an episode"
    for i, command in enumerate(COMMANDS):
        send_command(bench, 44 + i, command)
        bench.wait_distinct("eye_states", i + 2)
    assert bench.next_status()["state"] == "between episodes"


def test_the_last_observation_is_repeated_until_the_next_episode(bench: Bench) -> None:
    run_episode(bench)
    bench.graph.spin_until(
        lambda: observation_numbers(bench, "ground_truth").count(47) > 2, "two repeats"
    )
    last = [
        m for m in bench.outsider.heard["ground_truth"] if to_ns(m.header.stamp) >= 47 * PERIOD_NS
    ]
    assert last[-1] == last[-2] == last[-3]
    begin(bench, first_observation=48)
    bench.wait_distinct("left/image_raw", 4)
    assert distinct_numbers(bench, "left/image_raw") == [44, 45, 46, 48]


def test_older_and_repeated_commands_move_nothing(bench: Bench) -> None:
    begin(bench)
    bench.wait_heard("episode", 1)
    send_command(bench, 44)
    wait_for(bench, 45)
    for _ in range(3):
        send_command(bench, 44, (0.2, 0.0))
        send_command(bench, 3, (0.2, 0.0))
    send_command(bench, 45)
    wait_for(bench, 46)
    assert 47 not in observation_numbers(bench, "ground_truth")
    assert bench.node.diagnostics.n_refused == 0


def test_commands_outside_an_episode_move_nothing(bench: Bench) -> None:
    send_command(bench, 0)
    run_episode(bench)
    for observation in (46, 47):
        send_command(bench, observation)
    assert begin(bench, first_observation=48) == (True, "")
    bench.wait_distinct("ground_truth", 5)
    assert bench.node.diagnostics.n_refused == 0
    assert max(observation_numbers(bench, "ground_truth")) == 48


def test_after_the_end_of_a_run_the_plant_is_silent(bench: Bench) -> None:
    begin(bench)
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
        ("camera__width_px", "wide", "camera.width_px: expected an integer, got 'wide'"),
        ("mechanics__parameter_set", "k99", "mechanics.parameter_set: expected k17 or anatomical"),
        ("stimuli__directory", "/nowhere", "stimuli.directory: expected a directory of images"),
        ("camera__with_px", 320, "unknown parameter camera.with_px"),
    ],
)
def test_a_configuration_that_cannot_be_met(graph, name, value, message) -> None:
    with pytest.raises(InputError) as error:
        graph.add(EyePlantNode, **{name: value})
    assert message in str(error.value)
