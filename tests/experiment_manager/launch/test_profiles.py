"""Profiles: the files of the package, and texts that are none."""

import re

import pytest

from experiment_manager.launch.profiles import (
    Change,
    Profile,
    parse_profile,
    profile_names,
    read_profile,
)
from experiment_manager.run.config_file import CONFIG_CLASSES
from lockstep.configuration import build
from lockstep.errors import InputError


@pytest.mark.parametrize("name", profile_names())
def test_every_profile_of_the_package_is_one(name: str) -> None:
    profile = read_profile(name)
    assert profile.name == name
    for node, settings in profile.settings.items():
        build(CONFIG_CLASSES[node], settings)
    for change in profile.schedule:
        for place in change.settings:
            node, _, parameter = place.partition(".")
            build(CONFIG_CLASSES[node], {parameter: change.settings[place]})


def test_the_names_of_the_package() -> None:
    assert {"paper", "demonstration"} <= set(profile_names())
    assert read_profile("paper").settings == {}


def test_an_unknown_name_gets_the_nearest() -> None:
    with pytest.raises(InputError, match=r"got 'papper'; did you mean paper\?"):
        read_profile("papper")
    with pytest.raises(InputError, match=r"expected one of .*demonstration.*, got 'zzz'$"):
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
        (
            Change(100, {"eye_plant.camera.left_occluded": True}),
            Change(200, {"eye_plant.camera.left_occluded": False}),
        ),
    )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "expected the keys description, settings and perhaps schedule, got None"),
        ("[1", "expected YAML"),
        ("{description: x}", "expected the keys description, settings"),
        ("{description: x, settings: {}, colour: 1}", "got description, settings, colour"),
        ("{description: 1, settings: {}}", "expected a description in words, got 1"),
        ("{description: x, settings: {a: 1}}", "expected settings as {NODE: {parameter: value}}"),
        ("{description: x, settings: {}, schedule: 1}", "expected a list as schedule, got 1"),
        ("{description: x, settings: {}, schedule: [1]}", "in its schedule, got 1"),
        (
            "{description: x, settings: {}, schedule: [{at: 1.5, set: {a.b: 1}}]}",
            "expected {at: ITERATION, set: {NODE.PARAMETER: value}} in its schedule",
        ),
        (
            "{description: x, settings: {}, schedule: [{at: 9, set: {a.b: 1}}, "
            "{at: 9, set: {a.b: 2}}]}",
            "expected a schedule with growing iterations",
        ),
    ],
)
def test_what_is_no_profile(text: str, message: str) -> None:
    with pytest.raises(InputError, match=re.escape(message)) as caught:
        parse_profile("mine", text)
    assert str(caught.value).startswith("profile mine: expected ")
