"""The Gymnasium environments: Gymnasium's own checks, and the in-process loop as the oracle."""

import importlib.util
import json
import math
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import active_binocular_vision.environments  # noqa: F401 (registers them)
from active_binocular_vision.commands.command_line import arguments, request_of
from active_binocular_vision.environments.active_vergence import VergenceEnvironment
from experiment_manager import configuration_of, make_loop, protocol_of
from experiment_manager.run.config_file import Configuration
from experiment_manager.sections import config_of
from lockstep import InputError, write_state
from lockstep.wire.topics import GROUND_TRUTH_NAMES
from sparse_coder import SparseCoder, SparseCoderConfig
from sparse_coder.matching_pursuit import Selections, mean_squared_coefficients
from tests.patience import PATIENCE_S
from vergence_rl import Agent, VergenceRlConfig

EXAMPLE = Path(__file__).parents[3] / "docs" / "examples" / "gymnasium_agent.py"
IDS = ("ActiveVergence-v0", "ActiveVergenceFeatures-v0")
N_EPISODES = 8
LAMBDA = 0.08
# The left eye is covered in episodes 2 to 4; from 5 on the muscles are weaker, and all is noisy.
SCHEDULE = json.dumps(
    [
        {"at": 20, "set": {"eyes.camera.left_occluded": True}},
        {
            "at": 50,
            "set": {
                "eyes.camera.left_occluded": False,
                "eyes.mechanics.strength": [0.9] * 12,
                "eyes.noise.picture_sd": 4.0,
                "eyes.noise.activation_sd": 0.004,
                "eyes.noise.missing_pictures": 0.2,
            },
        },
    ]
)


@pytest.fixture(scope="module")
def settings(pictures: Path) -> dict[str, Any]:
    """Return settings small enough for tests, with a price on energy."""
    return {
        "eye_plant.stimuli.directory": str(pictures),
        "eye_plant.stimuli.size_px": 64,
        "task.metabolic_cost_weight": LAMBDA,
        "task.n_training_iterations": 10 * N_EPISODES,
    }


@pytest.fixture(params=IDS)
def environment(request, settings) -> Iterator[gymnasium.Env]:
    """Return one environment after the other, as gymnasium.make makes it."""
    made = gymnasium.make(request.param, model="M_C", settings=settings)
    yield made
    made.close()


@pytest.fixture
def bare(settings: dict[str, Any]) -> Iterator[VergenceEnvironment]:
    """Return the environment of features without Gymnasium's wrappers."""
    made = gymnasium.make(IDS[1], model="M_C", settings=settings).unwrapped
    assert isinstance(made, VergenceEnvironment)
    yield made
    made.close()


def test_an_environment_needs_neither_ros_nor_reports(settings: dict[str, Any]) -> None:
    make = f"gymnasium.make({IDS[1]!r}, model='M_C', settings={settings!r}).reset(seed=1)"
    program = (
        f"import sys, gymnasium, active_binocular_vision.environments; {make}; print(*sys.modules)"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        capture_output=True,
        text=True,
        check=True,
        timeout=PATIENCE_S,
    )
    loaded = {name.partition(".")[0] for name in done.stdout.split()}
    assert {"gymnasium", "sparse_coder"} <= loaded
    assert not loaded & {"rclpy", "rpyutils", "sensor_msgs", "builtin_interfaces"}
    assert not loaded & {"matplotlib", "mcap"}


@pytest.mark.filterwarnings("error")
def test_gymnasiums_own_checks_pass_without_a_warning(environment: gymnasium.Env) -> None:
    check_env(environment.unwrapped)


def test_features_of_any_dictionary_are_within_their_space(bare: VergenceEnvironment) -> None:
    observed, _ = bare.reset(seed=1)
    assert bare.observation_space.contains(observed)
    # Even of a code that spends both eyes' patches on one atom, in as many equal selections.
    selections = Selections(
        np.zeros((1, 10), np.int32), np.full((1, 10), math.sqrt(0.2), np.float32)
    )
    largest = mean_squared_coefficients(selections, 2).max()
    assert largest == pytest.approx(bare.observation_space["features"].high.max())  # type: ignore[index]


def test_a_closed_environment_says_that_it_is(bare: VergenceEnvironment) -> None:
    bare.reset(seed=1)
    bare.close()
    with pytest.raises(InputError, match=r"^step: expected it before close, got it after"):
        bare.step(np.zeros(2))
    with pytest.raises(InputError, match=r"^reset: expected it before close, got it after"):
        bare.reset()


def test_a_seed_that_no_run_takes_is_refused(bare: VergenceEnvironment) -> None:
    with pytest.raises(InputError, match=r"^seed: expected a whole number from -92"):
        bare.reset(seed=2**63)


def configuration(settings: dict[str, Any]) -> Configuration:
    line = ["--profile", "paper", "--model", "M_C", "--tests", "0"]
    line += [word for k, v in settings.items() for word in ("--set", f"{k}={v}")]
    return configuration_of(request_of(arguments(line)), "")


@pytest.mark.parametrize("rule", ["cacla", "hindsight"])
def test_our_agent_learns_the_same_numbers_as_in_the_loop(settings, rule) -> None:
    scheduled = settings | {"task.schedule": SCHEDULE}
    parameters = configuration(scheduled | {"vergence_rl.learning_rule": rule})
    loop = make_loop(parameters)
    protocol = protocol_of(parameters)
    expected_deg = []
    for episode in protocol.training_episodes():
        loop.plant.reconfigure(protocol.plant_settings(episode))
        *_, last = loop.run_episode(episode)
        expected_deg.append(last.observation.truth.vergence_error_deg)
    loop.plant.close()

    spec = importlib.util.spec_from_file_location("gymnasium_agent", EXAMPLE)
    assert spec is not None
    assert spec.loader is not None
    example = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(example)
    agent = Agent(config_of(VergenceRlConfig, parameters))
    environment = gymnasium.make(IDS[1], model="M_C", settings=scheduled)
    got_deg = example.train(environment, agent, N_EPISODES, seed=1)
    environment.close()

    assert got_deg == expected_deg
    assert len(got_deg) == N_EPISODES
    state, oracle = agent.state(), loop.agent.state()
    assert state.keys() == oracle.keys()
    for name, values in oracle.items():
        assert values.tobytes() == state[name].tobytes(), name


def test_ten_steps_then_truncated_and_never_terminated(environment: gymnasium.Env) -> None:
    for _ in range(2):
        environment.reset(seed=1)
        ends = [environment.step(np.zeros(2))[2:4] for _ in range(10)]
        assert ends == [(False, False)] * 9 + [(False, True)]


def test_a_step_after_the_end_is_refused(bare: VergenceEnvironment) -> None:
    bare.reset(seed=1)
    for _ in range(10):
        bare.step(np.zeros(2))
    with pytest.raises(InputError, match="expected a reset before"):
        bare.step(np.zeros(2))


def test_an_action_is_a_change_in_units_of_the_scale_within_the_limits(bare) -> None:
    assert bare.action_scale.tolist() == [0.25, 0.125]
    start = bare.reset(seed=1)[0]["activations"]
    expected = np.array([0.01, 0.0])
    up = bare.step(np.array([0.04, 0.0]))[0]["activations"]
    np.testing.assert_allclose(up, np.clip(start + expected, 0.0, [0.2, 0.1]), atol=1e-15)
    assert bare.step(np.array([1.0, 1.0]))[0]["activations"].tolist() == [0.2, 0.1]
    assert bare.step(np.array([-1.0, -1.0]))[0]["activations"].tolist() == [0.0, 0.0]


def test_the_reward_is_that_of_where_the_action_led(bare: VergenceEnvironment) -> None:
    bare.reset(seed=1)
    _, reward, _, _, info = bare.step(np.array([0.1, 0.0]))
    error = info["reconstruction_error_coarse"] + info["reconstruction_error_fine"]
    assert reward == pytest.approx(
        -error - LAMBDA * info["ground_truth"]["metabolic_rate_w"], rel=1e-12
    )
    assert info["ground_truth"]["iteration"] == 1


def test_ground_truth_is_in_info_only(environment: gymnasium.Env) -> None:
    observed, info = environment.reset(seed=1)
    assert set(info["ground_truth"]) == set(GROUND_TRUTH_NAMES)
    assert set(observed) < {"pictures", "features", "activations"}


def test_one_seed_is_one_experiment_from_nothing(bare: VergenceEnvironment) -> None:
    def first_features(seed: int | None) -> list[bytes]:
        found = []
        for _ in range(3):
            found.append(bare.reset(seed=seed)[0]["features"].tobytes())
            seed = None
        return found

    assert first_features(5) == first_features(5)
    assert first_features(5) != first_features(6)
    assert len(set(first_features(5))) == 3


def test_options_choose_an_episode_of_the_protocol(bare: VergenceEnvironment) -> None:
    truth = bare.reset(seed=1, options={"episode": 3})[1]["ground_truth"]
    assert (truth["phase"], truth["episode"]) == (0, 3)
    assert bare.reset()[1]["ground_truth"]["episode"] == 4
    truth = bare.reset(options={"trial": 2})[1]["ground_truth"]
    assert (truth["phase"], truth["trial"]) == (1, 2)
    ends = [bare.step(np.zeros(2))[3] for _ in range(20)]
    assert ends == [False] * 19 + [True]
    assert bare.reset()[1]["ground_truth"]["episode"] == 5


def test_any_episode_has_the_plant_of_its_stage_of_the_schedule(settings) -> None:
    scheduled = settings | {"task.schedule": SCHEDULE}
    made = gymnasium.make(IDS[0], model="M_C", settings=scheduled)

    def is_covered(**options: int) -> list[bool]:
        return [not picture.any() for picture in made.reset(seed=1, options=options)[0]["pictures"]]

    assert is_covered(episode=2) == [True, False]
    assert is_covered(episode=1) == [False, False]
    assert is_covered(episode=4) == [True, False]
    assert is_covered(trial=0) == [False, False]
    made.close()


def test_a_saved_coder_may_be_used_and_left_as_it_is(settings, tmp_path) -> None:
    coder = SparseCoder(SparseCoderConfig(seed=77))
    path = tmp_path / "sparse_coder.npz"
    write_state(path, "sparse_coder", coder.state())
    made = gymnasium.make(
        IDS[1], model="M_C", settings=settings, coder_state=path, coder_learns=False
    )
    first = made.reset(seed=1)[0]["features"]
    made.step(np.zeros(2))
    again = made.reset(seed=1)[0]["features"]
    pictures = gymnasium.make(IDS[0], model="M_C", settings=settings)
    expected = coder.encode(*pictures.reset(seed=1)[0]["pictures"]).features
    assert first.tobytes() == again.tobytes() == expected.tobytes()
    made.close()
    pictures.close()


def test_rendered_is_the_anaglyph_of_what_the_eyes_see(settings: dict[str, Any]) -> None:
    made = gymnasium.make(IDS[0], model="M_C", settings=settings, render_mode="rgb_array")
    left, right = made.reset(seed=1)[0]["pictures"]
    picture = made.render()
    assert isinstance(picture, np.ndarray)
    np.testing.assert_array_equal(picture, np.stack([left, right, right], axis=-1))
    made.close()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"distance": 2.0}, "expected one of episode, trial at most, got distance"),
        ({"episode": 1, "trial": 1}, "at most"),
        ({"episode": -1}, "from 0 to 7, got -1"),
        ({"trial": 10**6}, "trial: expected a whole number from 0"),
        ({"episode": 0.5}, "got 0.5"),
        ({"trial": "3"}, "got '3'"),
    ],
)
def test_bad_reset_options_are_one_error(bare, options, message) -> None:
    with pytest.raises(InputError, match=message):
        bare.reset(seed=1, options=options)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"model": "M_D"}, "model: expected M or M_C, got 'M_D'"),
        ({"profile": "thirteen"}, "profile: .*thirteen"),
        ({"settings": {"eye_plant.no_such": 1}}, "no_such"),
        (
            {"settings": {"nobody.seed": 1}},
            r"settings\['nobody.seed'\]: expected SECTION.NAME with",
        ),
        ({"action_scale": 0.0}, "action_scale: expected more than 0, at most 1, got 0.0"),
        ({"render_mode": "human"}, "render_mode: expected None or rgb_array"),
        ({"coder_state": "nowhere.npz"}, "nowhere.npz"),
    ],
)
def test_bad_arguments_are_one_error(arguments, message, settings) -> None:
    given = {"model": "M_C", "settings": settings} | arguments
    with pytest.raises(InputError, match=message):
        VergenceEnvironment(**given)


@pytest.mark.parametrize("action", [[0.1], [np.nan, 0.0], [0.0, 0.0, 0.0]])
def test_an_action_that_is_none_is_refused(bare: VergenceEnvironment, action: list[float]) -> None:
    bare.reset(seed=1)
    with pytest.raises(InputError, match="expected 2 finite numbers"):
        bare.step(np.array(action))


def test_each_muscle_has_an_action_of_its_own(settings: dict[str, Any]) -> None:
    environment = gymnasium.make(IDS[1], profile="twelve_m_c", settings=settings)
    check_env(environment.unwrapped, skip_render_check=True)
    before, info = environment.reset(seed=1)
    # More of the left superior rectus alone: that eye looks up, and is the higher one.
    action = np.zeros(12)
    action[2] = 0.02
    after, _, _, _, changed = environment.step(action)
    environment.close()
    assert after["activations"] - before["activations"] == pytest.approx(0.25 * action)
    rise_deg = (
        changed["ground_truth"]["vertical_error_deg"] - info["ground_truth"]["vertical_error_deg"]
    )
    # 302 deg per unit at the tonic level.
    assert rise_deg == pytest.approx(1.5, abs=0.4)


def test_an_agent_is_told_where_the_gaze_target_is(settings: dict[str, Any]) -> None:
    without_price = settings | {"task.metabolic_cost_weight": 0.0}
    environment = gymnasium.make(IDS[1], profile="gaze", settings=without_price)
    check_env(environment.unwrapped, skip_render_check=True)
    observed, info = environment.reset(seed=1)
    truth = info["ground_truth"]
    expected = [truth["target_sideways_deg"], truth["target_up_deg"]]
    environment.close()
    assert observed["gaze_target"].tolist() == expected
    assert 2.0 <= np.hypot(*expected) <= 10.5
