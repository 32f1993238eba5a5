"""Which runs are pooled, and what distinguishes groups."""

import copy
from typing import Any

import pytest
from msgspec.structs import replace

from active_binocular_vision import Run
from active_binocular_vision.figures.quartiles import colour_of
from active_binocular_vision.runs.groups import groups_of, held_back
from lockstep.errors import InputError


def test_runs_that_differ_in_nothing_but_the_seed_make_one_group(runs: list[Run]) -> None:
    m, m_c = runs
    groups = groups_of([m_c, m, m])
    assert [group.model for group in groups] == ["M", "M_C"]
    assert [len(group.runs) for group in groups] == [2, 1]
    assert "n = 2 seeds" in groups[0].label
    assert "0.08" in groups[1].label
    assert colour_of(groups[0]) != colour_of(groups[1])
    assert groups[0].iterations == [0, 130, 270, 400]
    assert len(groups[0].trials_at(130).trial) == 2 * 39


def test_a_run_goes_to_another_process_without_what_was_read(runs: list[Run]) -> None:
    assert runs[0].recorded.tests
    assert vars(runs[0].unread()).keys() == {"directory", "name"}


def _with(run: Run, section: str, **changed: Any) -> Run:
    """The same run as if settings of a section had been others; __ is the dot in a name."""
    other = copy.copy(run)
    named = {name.replace("__", "."): value for name, value in changed.items()}
    other.configuration = run.configuration | {section: run.configuration[section] | named}
    return other


def test_runs_with_other_settings_are_not_pooled(runs: list[Run]) -> None:
    run = runs[0]
    for section, free in (("task", {"seed": 5}), ("experiment_manager", {"commit": "abc"})):
        assert len(groups_of([run, _with(run, section, **free)])) == 1, free
    photos = _with(run, "eye_plant", stimuli__directory="/my/photos")
    other = _with(photos, "eyes", mechanics__parameter_set="anatomical")
    first, second = groups_of([run, other])
    assert first.label.endswith("parameter_set k17, n = 1 seed")
    assert first.name == "M, generated stimuli, parameter_set k17"
    assert second.label.endswith("photos stimuli, parameter_set anatomical, n = 1 seed")
    assert (first.rank, second.rank) == ((0, 2), (1, 2))


def test_every_setting_in_which_runs_differ_is_named(runs: list[Run]) -> None:
    strength = [0.5] * 12
    stimuli = {"stimuli__directory": "/my/photos", "stimuli__n_training": 14}
    other = _with(runs[0], "eye_plant", **stimuli, stimuli__n_test=6)
    other = _with(other, "eyes", mechanics__strength=strength)
    _, second = groups_of([runs[0], other])
    assert second.name.startswith("M, photos stimuli, ")
    for named in ("n_test 6", "n_training 14", f"strength {strength}"):
        assert named in second.name


def test_a_profile_says_for_all_its_settings_what_tells_runs_apart(
    runs: list[Run],
) -> None:
    paper = _with(runs[0], "experiment_manager", profile="paper")
    precise = _with(runs[0], "experiment_manager", profile="precise")
    third = _with(precise, "eyes", mechanics__parameter_set="anatomical")
    first, second = groups_of([paper, third])
    assert first.label.endswith(", profile paper, parameter_set k17, n = 1 seed")
    assert second.name == "M, profile precise, parameter_set anatomical"
    assert [group.name for group in groups_of([paper, precise])] == [
        "M, profile paper",
        "M, profile precise",
    ]
    names = [group.name for group in groups_of([paper, precise, third])]
    assert names == [
        "M, profile paper, parameter_set k17",
        "M, profile precise, parameter_set k17",
        "M, profile precise, parameter_set anatomical",
    ]


def test_a_parameter_that_is_lacking_has_its_default(runs: list[Run]) -> None:
    run, name = runs[0], "learning_rate"
    of_coder = dict(run.configuration["sparse_coder"])
    other = copy.copy(run)
    del of_coder[name]
    other.configuration = run.configuration | {"sparse_coder": of_coder}
    assert len(groups_of([run, other])) == 1
    other.configuration = run.configuration | {"sparse_coder": of_coder | {name: 0.3}}
    assert len(groups_of([run, other])) == 2


@pytest.mark.parametrize("course", ["branched_at_iteration", "extended_from"])
def test_a_run_of_another_course_is_not_pooled(runs, course) -> None:
    run, other = runs[0], copy.copy(runs[0])
    other.about = {**run.about, course: 100}
    first, second = groups_of([run, other])
    assert (first.name, second.name) == ("M", f"M, {course} 100")


def test_a_run_without_its_last_test_does_not_hold_back_finished_ones(runs) -> None:
    run, m_c = runs
    other = copy.copy(run)
    other.document = replace(run.document, tests=run.summaries[:2])
    other.tests = {test.iteration: run.tests[test.iteration] for test in other.summaries}
    assert held_back([run, other, m_c]) == [other]
    assert held_back([other, m_c]) == [], "nothing to be held back"
    run.document = replace(run.document, tests=run.summaries[2:])
    with pytest.raises(InputError, match="expected a test after as many iterations in each"):
        groups_of([run, other])


def _group_sizes(run: Run, seeds: list[tuple[int, int]]) -> list[int]:
    """Return the sizes of the groups of runs with the given seeds and seeds of the pictures."""
    runs = []
    for seed, pictures_seed in seeds:
        other = _with(run, "eye_plant", stimuli__seed=pictures_seed)
        other.about = {**run.about, "seed": seed}
        runs.append(other)
    return [len(group.runs) for group in groups_of(runs)]


def test_runs_with_a_seed_and_pictures_of_their_own_are_pooled(runs: list[Run]) -> None:
    assert _group_sizes(runs[0], [(1, 11), (2, 12), (3, 13)]) == [3]
    assert _group_sizes(runs[0], [(1, 1), (2, 1), (3, 1)]) == [3], "the same pictures"
    assert _group_sizes(runs[0], [(1, 11), (1, 12)]) == [1, 1], "pictures are compared"
    assert _group_sizes(runs[0], [(1, 11), (2, 11), (1, 12), (2, 12)]) == [2, 2]
    assert _group_sizes(runs[0], [(1, 1), (2, 1), (1, 11), (2, 12)]) == [2, 2]
    assert _group_sizes(runs[0], [(1, 11), (2, 12), (1, 13)]) == [1, 1, 1]
