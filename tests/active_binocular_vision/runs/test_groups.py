"""Which runs are pooled, and what tells groups apart."""

import copy

import pytest
import yaml

from active_binocular_vision.commands.command_line import arguments, request_of
from active_binocular_vision.runs.groups import groups_of, held_back
from active_binocular_vision.runs.reported_run import ReportedRun
from experiment_manager.preparation.configuration import configuration_of
from experiment_manager.run.config_file import configuration_text
from lockstep import InputError


def test_runs_that_differ_in_nothing_but_the_seed_make_one_group(runs: list[ReportedRun]) -> None:
    m, m_c = runs
    groups = groups_of([m_c, m, m])
    assert [group.model for group in groups] == ["M", "M_C"]
    assert [len(group.runs) for group in groups] == [2, 1]
    assert "2 runs" in groups[0].label
    assert "0.08" in groups[1].label
    assert groups[0].colour != groups[1].colour
    assert groups[0].iterations == [0, 130, 270, 400]
    assert len(groups[0].trials_at(130).trial) == 2 * 39


def test_runs_with_other_settings_are_not_pooled(runs) -> None:
    run = runs[0]
    other = copy.copy(run)
    for own, free in (("seed: 1", "seed: 5"), ("commit: 0123abc", "commit: abc")):
        assert own in run.configuration
        other.configuration = run.configuration.replace(own, free)
        assert len(groups_of([run, other])) == 1, free
    other.configuration = run.configuration.replace(
        "mechanics.parameter_set: k17",
        "mechanics.parameter_set: anatomical\n    stimuli.directory: /my/photos",
    )
    first, second = groups_of([run, other])
    assert first.label.endswith("parameter_set k17, 1 run")
    assert first.name == "M, parameter_set k17"
    assert second.label.endswith("photos stimuli, parameter_set anatomical, 1 run")
    assert first.colour != second.colour


def test_a_profile_says_for_all_its_settings_what_tells_runs_apart(runs) -> None:
    run = runs[0]
    other = copy.copy(run)
    other.configuration = run.configuration.replace(
        "mechanics.parameter_set: k17",
        "mechanics.parameter_set: anatomical\n    camera.roi_width_px: 128",
    )
    for one, profile in ((run, "paper"), (other, "precise")):
        document = yaml.safe_load(one.configuration)
        document["/**/experiment_manager"] = {"ros__parameters": {"profile": profile}}
        one.configuration = yaml.safe_dump(document)
    first, second = groups_of([run, other])
    assert first.label.endswith(", profile paper, 1 run")
    assert second.label.endswith(", profile precise, 1 run")
    assert second.name == "M, profile precise"
    # Where runs of one profile differ, it does not say in what.
    third = copy.copy(run)
    third.configuration = other.configuration.replace("set: anatomical", "set: k17")
    names = [group.name for group in groups_of([run, other, third])]
    assert names == [
        "M, profile paper",
        "M, profile precise, parameter_set anatomical",
        "M, profile precise, parameter_set k17",
    ]


def test_a_parameter_that_is_lacking_has_its_default(runs) -> None:
    run, other = runs[0], copy.copy(runs[0])
    text = configuration_text(configuration_of(request_of(arguments(["--model", "M"])), ""))
    line = "    camera.left_occluded: false\n"
    assert line in text
    run.configuration = text
    other.configuration = text.replace(line, "")
    assert len(groups_of([run, other])) == 1
    other.configuration = text.replace(line, line.replace("false", "true"))
    assert len(groups_of([run, other])) == 2
    other.configuration = text.replace(line, line + "    camera.own: 1\n")
    _, second = groups_of([run, other])
    assert second.name == "M, own 1"


@pytest.mark.parametrize("course", ["branched_at_iteration", "extended_from"])
def test_a_run_of_another_course_is_not_pooled(runs, course) -> None:
    run, other = runs[0], copy.copy(runs[0])
    other.about = {**run.about, course: 100}
    first, second = groups_of([run, other])
    assert (first.name, second.name) == ("M", f"M, {course} 100")


def test_a_run_without_its_last_test_does_not_hold_back_finished_ones(runs) -> None:
    run, m_c = runs
    other = copy.copy(run)
    other.summaries = run.summaries[:2]
    other.trials = {test.iteration: run.trials[test.iteration] for test in other.summaries}
    assert held_back([run, other, m_c]) == [other]
    assert held_back([other, m_c]) == [], "nothing to be held back"
    run.summaries = run.summaries[2:]
    with pytest.raises(InputError, match="expected a test after as many iterations in each"):
        groups_of([run, other])


def _group_sizes(run: ReportedRun, seeds: list[tuple[int, int]]) -> list[int]:
    """Return the sizes of the groups of runs with the given seeds and seeds of the pictures."""
    runs = []
    for seed, pictures_seed in seeds:
        other = copy.copy(run)
        other.about = {**run.about, "seed": seed}
        line = "mechanics.parameter_set: k17"
        assert line in run.configuration
        more = f"{line}\n    stimuli.seed: {pictures_seed}"
        other.configuration = run.configuration.replace(line, more)
        runs.append(other)
    return [len(group.runs) for group in groups_of(runs)]


def test_runs_with_a_seed_and_pictures_of_their_own_are_pooled(runs: list[ReportedRun]) -> None:
    assert _group_sizes(runs[0], [(1, 11), (2, 12), (3, 13)]) == [3]
    assert _group_sizes(runs[0], [(1, 1), (2, 1), (3, 1)]) == [3], "the same pictures"
    assert _group_sizes(runs[0], [(1, 11), (1, 12)]) == [1, 1], "pictures are compared"
    assert _group_sizes(runs[0], [(1, 11), (2, 11), (1, 12), (2, 12)]) == [2, 2]
    assert _group_sizes(runs[0], [(1, 1), (2, 1), (1, 11), (2, 12)]) == [2, 2]
    assert _group_sizes(runs[0], [(1, 11), (2, 12), (1, 13)]) == [1, 1, 1]
