"""Profiles: the files of the package, and texts that are none."""

import re

import numpy as np
import pytest

from experiment_manager import make_loop, protocol_of
from experiment_manager.plant_changes import Change, Schedule
from experiment_manager.preparation.profile_paths import profile_files
from experiment_manager.preparation.profiles import (
    Profile,
    parse_profile,
    read_profile,
)
from experiment_manager.sections import config_of
from eye_plant import EyePlantConfig
from eye_plant.mechanics.oculomotor import Oculomotor
from lockstep import InputError
from tests.command_lines import configured


def test_the_names_of_the_package() -> None:
    assert {"paper", "demonstration"} <= set(profile_files())
    assert read_profile("paper").settings == {}


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("papper", r"got 'papper'; did you mean paper\?$"),
        ("zzz", r"expected one of .*, got 'zzz'$"),
        # A name is no path.
        (
            "../profiles/paper",
            "profile: expected a known name, got '../profiles/paper'; did you mean paper",
        ),
        ("", "profile: expected one of"),
    ],
)
def test_an_unknown_name_gets_the_nearest(name: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        read_profile(name)


def test_what_a_profile_may_hold() -> None:
    text = """
    description: One eye covered from 100 on.
    settings: {vergence_rl: {cacla.discount: 0.5}}
    schedule:
    - {at: 100, set: {eyes.camera.left_occluded: true}}
    - {at: 200, set: {eyes.camera.left_occluded: false}}
    """
    assert parse_profile("covered", text) == Profile(
        "covered",
        "One eye covered from 100 on.",
        {"vergence_rl": {"cacla.discount": 0.5}},
        Schedule(
            (
                Change(100, {"eyes.camera.left_occluded": True}),
                Change(200, {"eyes.camera.left_occluded": False}),
            )
        ),
    )


def test_a_base_holds_where_a_profile_has_no_setting_of_its_own() -> None:
    text = """
    description: The demonstration, longer.
    base: demonstration
    settings: {task: {n_training_iterations: 80000}, sparse_coder: {learning_rate: 2.0}}
    """
    base, profile = read_profile("demonstration"), parse_profile("longer", text)
    assert profile.settings["vergence_rl"] == base.settings["vergence_rl"]
    assert profile.settings["sparse_coder"] == {
        **base.settings["sparse_coder"],
        "learning_rate": 2.0,
    }
    assert profile.settings["task"] == {**base.settings["task"], "n_training_iterations": 80000}
    for base_name, message in (("papper", "did you mean"), ("clinic/patching", "a base without")):
        with pytest.raises(InputError, match=message):
            parse_profile("mine", f"{{description: x, settings: {{}}, base: {base_name}}}")


@pytest.mark.parametrize("name", sorted(profile_files()))
def test_every_profile_has_a_protocol_which_tests_the_end_of_a_condition(name: str) -> None:
    configuration = configured("--profile", name)
    assert len(protocol_of(configuration)) > 0
    tests = configuration["experiment_manager"]["test_iterations"]
    is_condition = name.startswith(("rearing/", "clinic/"))
    assert not is_condition or configuration["task"]["n_training_iterations"] in tests


# Each command space and learning rule, with saccades and without, a covered eye, a schedule.
KINDS = (
    *("paper", "precise_m_c", "twelve", "twelve_m_c", "gaze_m_c"),
    *("rearing/monocular", "clinic/surgery"),
)


@pytest.mark.parametrize("name", KINDS)
def test_a_profile_of_each_kind_runs_in_each_stage_of_its_schedule(name, pictures) -> None:
    line = ["--profile", name, "--stimuli", str(pictures), "--test-stimuli", "1"]
    configuration = configured(*line, "--set", "eye_plant.stimuli.size_px=64")
    protocol = protocol_of(configuration)
    loop = make_loop(configuration)
    try:
        first_segments = {(s.stage, s.i_test < 0): s for s in reversed(protocol.segments)}
        for segment in sorted(first_segments.values(), key=lambda s: s.first):
            episode = protocol.episode(segment.first)
            loop.plant.reconfigure(protocol.plant_settings(episode))
            *_, end = loop.run_episode(episode)
            assert end.observation.iteration == episode.n_iterations
    finally:
        loop.plant.close()


@pytest.mark.parametrize(
    ("name", "inward_deg"),
    [
        (f"clinic/{kind}tropia_{size_deg}", sign * size_deg)
        for kind, sign in (("eso", 1), ("exo", -1))
        for size_deg in (5, 10, 20)
    ],
)
def test_strabismus_has_its_angle_at_the_tonic_level(name: str, inward_deg: int) -> None:
    eyes = Oculomotor(config_of(EyePlantConfig, read_profile(name).settings).mechanics)
    eyes.settle(eyes.tonic_activations)
    left_deg, right_deg = np.degrees(eyes.state().eye_angles_rad)[:, 0]
    assert (left_deg, right_deg) == pytest.approx((0.0, inward_deg), abs=0.05)


@pytest.mark.parametrize(
    ("name", "inward_deg"),
    [
        ("healthy", 0),
        *((f"esotropia_{angle_deg}", angle_deg) for angle_deg in (5, 10, 20)),
        ("exotropia_10", -10),
    ],
)
def test_constant_strabismus_is_level_and_begins_at_the_tonic_level(name, inward_deg) -> None:
    configuration = configured("--profile", f"constant/{name}")
    eyes = Oculomotor(config_of(EyePlantConfig, configuration).mechanics)
    eyes.settle(eyes.tonic_activations)
    left_deg, right_deg = np.degrees(eyes.state().eye_angles_rad)
    assert left_deg[:2] == pytest.approx((1.6, 0.0), abs=0.1)
    assert right_deg[:2] == pytest.approx((1.6 + inward_deg, 0.0), abs=0.1)
    protocol = protocol_of(configuration)
    training = next(segment for segment in protocol.segments if segment.i_test < 0)
    first = protocol.episode(training.first)
    assert first.activations == pytest.approx(eyes.tonic_activations)


def _changes_the_eyes(name: str) -> bool:
    profile = read_profile(name)
    plant = config_of(EyePlantConfig, profile.settings)
    plants = profile.schedule.plants(plant)
    return any(plant.mechanics != EyePlantConfig().mechanics for plant in plants)


@pytest.mark.parametrize(
    "name", [name for name in sorted(profile_files()) if _changes_the_eyes(name)]
)
def test_unlike_eyes_come_to_all_that_their_protocol_draws(name: str) -> None:
    protocol = protocol_of(configured("--profile", name))
    for segment in protocol.segments:
        # Of tests, these are all conditions.
        for place in range(segment.first, segment.first + min(segment.n_episodes, 40)):
            protocol.episode(place)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "expected the keys description, settings and perhaps base and schedule, got"),
        ("[1", "expected YAML"),
        ("{description: x}", "expected the keys description, settings"),
        ("{description: x, settings: {}, colour: 1}", "got description, settings, colour"),
        ("{description: 1, settings: {}}", "expected a description in words, got 1"),
        ("{description: x, settings: {a: 1}}", "expected settings as {SECTION: {name: value}}"),
        ("{description: x, settings: {}, schedule: 1}", "schedule: expected a list of {at, set}"),
        ("{description: x, settings: {}, schedule: [1]}", "schedule: expected {at: ITERATION, set"),
    ],
)
def test_what_is_no_profile(text: str, message: str) -> None:
    with pytest.raises(InputError, match=re.escape(message)) as caught:
        parse_profile("mine", text)
    assert str(caught.value).startswith("profile mine: ")
