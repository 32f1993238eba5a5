"""Profiles: the files of the package, and texts that are none."""

import re

import pytest

from experiment_manager.experiment.config import ExperimentManagerConfig
from experiment_manager.experiment.plant_changes import Change, Schedule
from experiment_manager.experiment.protocol import make_protocol
from experiment_manager.preparation.command_line import arguments
from experiment_manager.preparation.configuration import configuration_of
from experiment_manager.preparation.profiles import (
    Profile,
    parse_profile,
    profile_names,
    read_profile,
)
from experiment_manager.run.config_file import CONFIG_CLASSES
from eye_plant.config import EyePlantConfig
from lockstep.configuration import build
from lockstep.errors import InputError


@pytest.mark.parametrize("name", profile_names())
def test_every_profile_of_the_package_is_one(name: str) -> None:
    profile = read_profile(name)
    assert profile.name == name
    for node, settings in profile.settings.items():
        build(CONFIG_CLASSES[node], settings)
    plant = build(EyePlantConfig, profile.settings.get("eye_plant", {}))
    assert len(profile.schedule.plants(plant)) == len(profile.schedule.changes) + 1


def test_the_names_of_the_package() -> None:
    assert {"paper", "demonstration"} <= set(profile_names())
    assert read_profile("paper").settings == {}


def test_an_unknown_name_gets_the_nearest() -> None:
    with pytest.raises(InputError, match=r"got 'papper'; did you mean paper\?"):
        read_profile("papper")
    with pytest.raises(InputError, match=r"expected one of .*, got 'zzz'$"):
        read_profile("zzz")


@pytest.mark.parametrize("name", ["../profiles/paper", "paper.yaml", ""])
def test_a_name_is_no_path(name: str) -> None:
    with pytest.raises(InputError, match="profile: expected one of"):
        read_profile(name)


def test_what_a_profile_may_hold() -> None:
    text = """
    description: One eye covered from 100 on.
    settings: {vergence_rl: {discount: 0.5}}
    schedule:
    - {at: 100, set: {eye_plant.camera.left_occluded: true}}
    - {at: 200, set: {eye_plant.camera.left_occluded: false}}
    """
    assert parse_profile("covered", text) == Profile(
        "covered",
        "One eye covered from 100 on.",
        {"vergence_rl": {"discount": 0.5}},
        Schedule(
            (
                Change(100, {"eye_plant.camera.left_occluded": True}),
                Change(200, {"eye_plant.camera.left_occluded": False}),
            )
        ),
    )


def test_a_base_holds_where_a_profile_has_no_setting_of_its_own() -> None:
    text = """
    description: The demonstration, longer.
    base: demonstration
    settings: {experiment_manager: {protocol.n_training_iterations: 80000}, sparse_coder: {seed: 2}}
    """
    base, profile = read_profile("demonstration"), parse_profile("longer", text)
    assert profile.settings["vergence_rl"] == base.settings["vergence_rl"]
    assert profile.settings["sparse_coder"] == {**base.settings["sparse_coder"], "seed": 2}
    expected = {**base.settings["experiment_manager"], "protocol.n_training_iterations": 80000}
    assert profile.settings["experiment_manager"] == expected


def test_a_base_that_is_no_profile_or_has_a_schedule_is_refused() -> None:
    for base, message in (("papper", "did you mean paper"), ("rearing/patching", "a base without")):
        with pytest.raises(InputError, match=message):
            parse_profile("mine", f"{{description: x, settings: {{}}, base: {base}}}")


@pytest.mark.parametrize("name", [name for name in profile_names() if name.startswith("rearing/")])
def test_every_condition_of_rearing_is_a_run(name: str) -> None:
    line = ["--profile", name, "--model", "M_C"]
    configuration = configuration_of(arguments(line), "0123abc")
    manager = configuration["experiment_manager"]
    make_protocol(build(ExperimentManagerConfig, manager)).episode(0)
    n_iterations = manager["protocol.n_training_iterations"]
    assert n_iterations in manager["protocol.test_iterations"], "its end is not tested"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "expected the keys description, settings and perhaps base and schedule, got"),
        ("[1", "expected YAML"),
        ("{description: x}", "expected the keys description, settings"),
        ("{description: x, settings: {}, colour: 1}", "got description, settings, colour"),
        ("{description: 1, settings: {}}", "expected a description in words, got 1"),
        ("{description: x, settings: {a: 1}}", "expected settings as {NODE: {parameter: value}}"),
        ("{description: x, settings: {}, schedule: 1}", "schedule: expected a list of {at, set}"),
        ("{description: x, settings: {}, schedule: [1]}", "schedule: expected {at: ITERATION, set"),
    ],
)
def test_what_is_no_profile(text: str, message: str) -> None:
    with pytest.raises(InputError, match=re.escape(message)) as caught:
        parse_profile("mine", text)
    assert str(caught.value).startswith("profile mine: ")
