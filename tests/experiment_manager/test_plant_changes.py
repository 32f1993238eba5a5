from dataclasses import replace

import pytest

from experiment_manager import Protocol, make_protocol
from experiment_manager.config import ExperimentManagerConfig, ProtocolConfig
from experiment_manager.plant_changes import (
    Change,
    Schedule,
    parse_schedule,
    read_schedule,
)
from experiment_manager.starts import PairStarts
from eye_plant import EyePlantConfig
from eye_plant.mechanics.mujoco_model import N_MUSCLES
from lockstep import InputError, build
from lockstep.wire.topics import TEST, TRAINING
from tests.pair import pair_activations

PATCHING = """
- {at: 40, set: {eyes.camera.left_occluded: true}}
- {at: 80, set: {eyes.camera.left_occluded: false, eyes.mechanics.baseline_m: 0.06}}
"""


def entry(at=10, **settings):
    return {"at": at, "set": settings or {"eyes.camera.left_blur_px": 1.0}}


def test_a_change_holds_for_the_episodes_that_begin_at_its_iteration_or_later():
    schedule = read_schedule(PATCHING)
    stages = [schedule.stage(TRAINING, iteration) for iteration in range(0, 100, 10)]
    assert stages == [0, 0, 0, 0, 1, 1, 1, 1, 2, 2]


def test_a_test_at_the_very_iteration_finds_the_plant_as_it_was():
    schedule = read_schedule(PATCHING)
    assert [schedule.stage(TEST, n) for n in (0, 40, 50, 80, 90)] == [0, 0, 1, 1, 2]


def test_later_changes_add_to_earlier_ones():
    schedule = read_schedule(PATCHING)
    assert schedule.settings(0) == {}
    assert schedule.settings(1) == {"camera.left_occluded": True}
    assert schedule.settings(2) == {"camera.left_occluded": False, "mechanics.baseline_m": 0.06}
    plants = schedule.plants(build(EyePlantConfig, {"camera.right_blur_px": 2.0}))
    assert [plant.camera.left_occluded for plant in plants] == [False, True, False]
    assert [plant.mechanics.baseline_m for plant in plants] == [0.056, 0.056, 0.06]
    assert {plant.camera.right_blur_px for plant in plants} == {2.0}


def test_a_change_is_told_as_numbers():
    first, second = read_schedule(PATCHING).changes
    assert first.numbers() == {"eyes.camera.left_occluded": 1.0}
    assert second.numbers() == {
        "eyes.camera.left_occluded": 0.0,
        "eyes.mechanics.baseline_m": 0.06,
    }


def test_each_entry_of_a_list_has_a_name():
    weak = [1.0] * N_MUSCLES
    weak[7] = 0.4
    schedule = parse_schedule([entry(**{"eyes.mechanics.strength": weak})])
    told = schedule.changes[0].numbers()
    assert list(told) == [f"eyes.mechanics.strength[{i}]" for i in range(N_MUSCLES)]
    assert told["eyes.mechanics.strength[7]"] == 0.4


def test_a_schedule_comes_back_from_its_text():
    schedule = read_schedule(PATCHING)
    assert read_schedule(schedule.text()) == schedule
    assert Schedule().text() == ""
    assert read_schedule("") == Schedule()


@pytest.mark.parametrize(
    ("entries", "message"),
    [
        ("soon", r"expected a list of \{at, set\}, got 'soon'"),
        ([{"at": 10}], r"expected \{at: ITERATION, set: .*got \{'at': 10\}"),
        ([entry(at=0)], "expected a training iteration of 1 or more .* got 0"),
        ([entry(at=1.5)], "got 1.5"),
        ([{"at": 10, "set": {}}], "at 10: expected .* as `set`, got {}"),
        ([entry(20), entry(10)], "expected increasing iterations, got 10 after 20"),
        ([entry(20), entry(20)], "expected increasing iterations, got 20 after 20"),
        (
            [entry(**{"eye_plant.camera.left_blurr_px": 1.0})],
            "at 10: .*got 'eye_plant.camera.left_blurr_px'; did you mean eyes.camera.left_blur_px",
        ),
        (
            [entry(**{"vergence_rl.cacla.discount": 0.1})],
            "expected a setting of the eyes that may change",
        ),
        ([entry(**{"eyes.camera.width_px": 64})], "got 'eyes.camera.width_px'"),
        ([entry(**{"eyes.mechanics.parameter_set": "k17"})], "that may change"),
        # The coder measures turns, and is not told of changes.
        ([entry(**{"eyes.noise.turn_sd_deg": 0.1})], "that may change"),
    ],
)
def test_what_is_no_schedule_is_refused(entries, message):
    with pytest.raises(InputError, match=message):
        parse_schedule(entries)


def test_text_that_is_no_yaml_is_refused():
    with pytest.raises(InputError, match="schedule: expected YAML"):
        read_schedule("[{at: 10")


@pytest.mark.parametrize(
    ("schedule", "message"),
    [
        ("[{at: 45, set: {eyes.camera.left_blur_px: 1.0}}]", "a multiple of 10 .* got 45"),
        ("[{at: 100, set: {eyes.camera.left_blur_px: 1.0}}]", "below 100 .* got 100"),
        ("[{at: 50, set: {eyes.camera.left_blur_px: -1.0}}]", "at 50: .*left_blur_px"),
        ("[{at: 50, set: {eyes.camera.left_blur_px: thick}}]", "at 50: .*got 'thick'"),
    ],
)
def test_a_schedule_that_the_run_or_the_plant_cannot_keep_is_refused(schedule, message):
    with pytest.raises(InputError, match=message):
        ExperimentManagerConfig(n_training_iterations=100, schedule=schedule)


def protocol_with_changes(*ats):
    config = ProtocolConfig(
        n_training_iterations=120,
        test_iterations=(0, 50),
        n_training_stimuli=5,
        n_test_stimuli=3,
        n_stimuli_per_test=1,
    )

    def starts(stage):
        def activations(_, fraction):
            return pair_activations(0.01 * stage, fraction / 10.0)

        return PairStarts(config, 0.056, activations)

    schedule = Schedule(tuple(Change(at, {}) for at in ats))
    return Protocol(config, 1, [starts(stage) for stage in range(1 + len(ats))], schedule)


def test_each_episode_starts_from_what_the_eyes_of_its_stage_can_do():
    protocol = protocol_with_changes(50, 80)
    episodes = [protocol.episode(place) for place in range(len(protocol))]
    for place, episode in enumerate(episodes):
        at = episode.training_iteration
        expected = sum(at >= a if episode.phase == TRAINING else at > a for a in (50, 80))
        assert protocol.segment(place).stage == expected
        assert episode.activations[0] == pytest.approx(0.01 * expected)


def test_stages_change_neither_numbers_nor_draws_of_episodes():
    plain, staged = protocol_with_changes(), protocol_with_changes(50, 80)
    assert len(plain) == len(staged)
    for place in range(len(plain)):
        before, after = plain.episode(place), staged.episode(place)
        assert (before.first_observation, before.stimulus, before.trial, before.episode) == (
            after.first_observation,
            after.stimulus,
            after.trial,
            after.episode,
        )
        assert before.object_distance_m == after.object_distance_m
        assert before.activations[1] == after.activations[1]


def test_the_run_draws_activations_for_the_mechanics_in_force():
    changed = "[{at: 50, set: {eyes.mechanics.rest_adduction_deg: [0.0, 3.0]}}]"
    small = ExperimentManagerConfig(
        n_training_iterations=100, test_iterations=(0,), n_stimuli_per_test=1
    )
    plain, staged = (make_protocol(replace(small, schedule=schedule)) for schedule in ("", changed))
    before, after = plain.n_trials + 4, plain.n_trials + 5
    assert plain.episode(before) == staged.episode(before)
    assert plain.episode(after) != staged.episode(after)
