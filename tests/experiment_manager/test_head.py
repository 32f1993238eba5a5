"""Whole runs with a robot's head in the place of the eyes."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import active_binocular_vision as abv
from experiment_manager import Bag, protocol_of
from experiment_manager.measures.tables import in_words, summaries_table
from experiment_manager.run.config_file import CONFIG_FILE, read_configuration
from experiment_manager.run.episode_record import TimedRecord
from experiment_manager.run.recorded_topics import SMALL_TOPICS_OF_HEADS
from experiment_manager.sections import completed
from eye_plant import StimulusSet, desired_vergence_deg
from lockstep import InputError
from lockstep.wire.topics import CAMERA_INFOS
from tests.cast_head import FOCAL_PX, CastHead
from tests.eye_plant.head.test_head_plant import EPISODE

# Larger steps of the learner and fewer basis functions than a run that is to be precise.
QUICK = {
    "task.n_bases": 100,
    "task.n_selections": 5,
    "task.iterations_per_trial": 10,
    "vergence_rl.hindsight.regression_period": 50,
    "vergence_rl.hindsight.memory_share": 0.25,
    "experiment_manager.object_distance_m": [0.7, 3.0],
    "experiment_manager.fixation_distance_m": [0.7, 3.0],
    "experiment_manager.test_distances_m": [1.0, 2.0],
    "experiment_manager.least_start_error_deg": -2,
}
Make = Callable[..., abv.Run]


def _texture(draw: np.random.Generator) -> np.ndarray:
    """Return squares of all sizes: edges, and about the spectrum of natural scenes."""
    noise = sum(
        np.kron(draw.normal(size=(n, n)), np.ones([512 // n] * 2)) / math.sqrt(n)
        for n in 2 ** np.arange(1, 10)
    )
    return np.clip(128.0 + 50.0 * noise / np.std(noise), 0.0, 255.0).astype(np.uint8)


@pytest.fixture(scope="module")
def stimuli() -> StimulusSet:
    draw = np.random.default_rng(0)
    training, test = ([_texture(draw) for _ in range(n)] for n in (10, 2))
    return StimulusSet(tuple(training), tuple(test))


@pytest.fixture(scope="module")
def make(stimuli: StimulusSet, tmp_path_factory: pytest.TempPathFactory) -> Make:
    """Return a function that makes a run with a head."""

    def make(n: int, *, knows: bool = True) -> abv.Run:
        head = CastHead(stimuli, knows=knows)
        out = tmp_path_factory.mktemp("head") / "run"
        return abv.run(
            "precise",
            head=head,
            iterations=n,
            tests=[0],
            test_stimuli=2,
            settings=QUICK,
            seed=1,
            out=out,
        )

    return make


def test_it_learns_to_half_a_pixel(make: Make) -> None:
    first, last = make(8000).summaries
    assert first.median_abs_vergence_error_deg == pytest.approx(1.0, abs=0.01)
    assert last.median_abs_vergence_error_deg is not None
    assert last.median_abs_vergence_error_deg < 0.5 * math.degrees(math.atan(1.0 / 257.34))


def test_what_a_run_of_joints_records(make: Make) -> None:
    run = make(20)
    configuration = read_configuration(run.directory / CONFIG_FILE)
    assert configuration["task"]["command_space"] == "vergence"
    assert configuration["eyes"]["mechanics.baseline_m"] == CastHead.baseline_m
    # The pictures are brought to the coder's focal length.
    assert configuration["eyes"]["camera.focal_length_px"] == 257.34 != FOCAL_PX
    bag = Bag(run.directory / "bag")
    tables = bag.vectors(*SMALL_TOPICS_OF_HEADS)
    assert tables["joint_states"].names == tables["joint_command"].names == ("vergence",)
    assert not bag.has("muscle_activations")
    truth, states = tables["ground_truth"], tables["joint_states"]
    np.testing.assert_allclose(
        truth.column("vergence_deg"), np.degrees(states.column("vergence")), atol=1e-12
    )
    assert np.isnan(truth.column("metabolic_rate_w")).all()
    assert np.isnan(tables["reward"].column("metabolic_rate_w")).all()
    assert (tables["reward"].column("energy_penalty") == 0.0).all()
    assert all(len(bag.stamps_ns(topic)) for topic in CAMERA_INFOS)
    table = summaries_table(run.summaries)
    assert "|vergence|" in table
    assert not any(word in table for word in ("C/C*", " c ", "active"))
    assert "energy" not in in_words(run.summaries[-1], 0.2)


def test_results_of_a_head_that_does_not_know_the_truth(make: Make) -> None:
    run = make(20, knows=False)
    (first, last) = run.summaries
    assert first.n_trials == last.n_trials == 20
    assert last.median_abs_vergence_error_deg is last.share_within_1_px is None
    assert "does not say where its cameras should look" in in_words(last, 0.2)
    assert summaries_table(run.summaries).split() == ["iteration", "trials", "0", "20", "20", "20"]


def test_starts_are_asked_in_angles() -> None:
    asked: dict[str, dict[str, Any]] = {
        "task": {"command_space": "pan_tilt_vergence", "n_training_iterations": 100},
        "eyes": {"mechanics.baseline_m": 0.06},
        "experiment_manager": {"start_version_deg": [10.0, 4.0]},
    }
    protocol = protocol_of(completed(asked))
    episodes = [protocol.episode(place) for place in range(len(protocol))]
    trials = [episode for episode in episodes if episode.phase]
    for trial, condition in zip(trials, protocol.conditions * 80, strict=False):
        vergence_deg = math.degrees(trial.joints_rad[2])
        desired_deg = desired_vergence_deg(trial.object_distance_m, 0.06)
        assert desired_deg - vergence_deg == pytest.approx(condition.start_error_deg)
    pans, tilts = np.degrees([episode.joints_rad[:2] for episode in episodes]).T
    assert 9.0 < np.abs(pans).max() <= 10.0
    assert 3.6 < np.abs(tilts).max() <= 4.0
    assert all(not episode.activations for episode in episodes)


def test_a_run_of_joints_without_a_head_is_refused_before_anything_is_written(tmp_path) -> None:
    with pytest.raises(InputError, match="command_space vergence: expected a head"):
        abv.run("precise", settings={"task.command_space": "vergence"}, out=tmp_path / "run")
    assert not (tmp_path / "run").exists()


def test_a_price_on_energy_needs_muscles() -> None:
    task = {"command_space": "vergence", "metabolic_cost_weight": 0.1}
    with pytest.raises(InputError, match="expected 0 with command_space vergence"):
        completed({"task": task})


def test_episodes_of_a_clocks_time_are_numbered_by_what_they_say() -> None:
    record = TimedRecord(EPISODE, SMALL_TOPICS_OF_HEADS)  # observations 44, 45, 46
    assert not record.note(900, 43)
    assert record.note(1000, 44)
    assert record.note(1007, 45)
    assert [record.holds(stamp) for stamp in (900, 1000, 1003, 1007)] == [False, True, False, True]
    assert (record.first_ns, record.last_ns) == (1000, -1)
    assert record.note(1900, 46)
    assert (record.iteration(1900), record.last_ns) == (2, 1900)
    assert record.expects("joint_states", 1900)
    assert not record.expects("reward", 1900), "nobody answers the last one"
    for topic, n_messages in (("joint_states", 3), ("ground_truth", 3), ("episode", 3)):
        for _ in range(n_messages):
            record.count(topic)
    assert not record.is_complete
    for topic in ("reward", "joint_command", "actor_critic"):
        record.count(topic)
        record.count(topic)
    assert record.is_complete
