"""Runs that belong together in a figure: those that differ in their seeds alone."""

import contextlib
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from active_binocular_vision.runs.recorded import RecordedTest
from active_binocular_vision.runs.run import Run
from experiment_manager import Criteria, Summary, summary_of
from experiment_manager.measures.trials import Trials, pooled
from experiment_manager.preparation.profiles import read_profile
from experiment_manager.run.config_file import FREE_TO_CHANGE, RUN_SECTION
from experiment_manager.sections import DEFAULTS, by_key, completed
from eye_plant.mechanics.mujoco_model import MechanicsConfig
from lockstep import InputError

_STIMULI, _PROFILE = "eye_plant.stimuli.directory", "experiment_manager.profile"
_PICTURES_SEED, _OF_EACH = "eye_plant.stimuli.seed", "of each run"
# Parameters that change no number that a figure shows: who made the run, where, how often it was
# saved, when it was tested, and how much of the pictures was drawn that nobody codes.
_NO_SETTINGS = (
    "seed",
    "metabolic_cost_weight",
    "model",
    *FREE_TO_CHANGE["experiment_manager"],
    "pictures_every_n_episodes",
    "pictures_every_n_trials",
    "n_training_iterations",
    "test_iterations",
    "camera.roi_width_px",
    "camera.roi_height_px",
)
# A run's plant does not run freely.
_NO_PART = "eye_plant.free_running."
# Of what a run is, the course that settings do not show.
_COURSE = ("branched_at_iteration", "extended_from")
# Characters of a label in a figure; the tables of a report have the whole name.
_LONGEST_LABEL = 200


@dataclass(frozen=True)
class Common:
    """What the runs of a group have in common; settings: all else, (SECTION.NAME, value)."""

    model: str
    weight: float
    n_iterations: int
    settings: frozenset[tuple[str, str]]


@dataclass(frozen=True)
class Group:
    """Runs that differ in their seeds alone; their trials are pooled, as K17 does.

    Their pictures are the same, or each run has a seed and pictures of its own.

    name: model, lambda, and how it differs from other groups of its model, as text; label: for
    figures; rank: (i, n), the i-th of the n groups of its model.
    """

    name: str
    label: str
    rank: tuple[int, int]
    common: Common
    runs: tuple[Run, ...]

    @property
    def model(self) -> str:
        """M or M_C."""
        return self.common.model

    @property
    def is_of_pair(self) -> bool:
        """Whether two activations are commanded, the same in both eyes, as in K17."""
        return self.runs[0].is_of_pair

    @property
    def iterations(self) -> list[int]:
        """Training iterations before each test that all runs made, in order."""
        made = [{test.iteration for test in run.summaries} for run in self.runs]
        if self.has_trials:
            made += [set(run.tests) for run in self.runs]
        return sorted(set.intersection(*made))

    @property
    def recorded_iterations(self) -> list[int]:
        """Those of `iterations` whose test is in a bag; a bag may begin at a later checkpoint."""
        return [iteration for iteration in self.iterations if self.recorded_at(iteration)]

    @property
    def has_trials(self) -> bool:
        """Whether the trials of all runs are known, and not their measures alone."""
        return all(run.tests for run in self.runs)

    def trials_at(self, iteration: int) -> Trials:
        """Return the trials of all runs after so many training iterations."""
        return pooled([run.tests[iteration] for run in self.runs])

    @cached_property
    def last_trials(self) -> Trials:
        """The trials of all runs in their last common test."""
        return self.trials_at(self.iterations[-1])

    @property
    def last_criteria(self) -> Criteria:
        """What the measures count in the last common test: the same in all runs."""
        return self.runs[0].evaluation_settings.criteria(self.iterations[-1])

    @property
    def last_mechanics(self) -> MechanicsConfig:
        """The eyes and muscles of the last common test: the same in all runs."""
        return self.runs[0].evaluation_settings.tested_plant(self.iterations[-1]).mechanics

    def summaries_at(self, iteration: int) -> list[Summary]:
        """Return each run's measures after so many training iterations."""
        return [test for run in self.runs for test in run.summaries if test.iteration == iteration]

    @cached_property
    def last_summary(self) -> Summary | None:
        """The measures of the last common test, trials pooled; None where trials are not known."""
        if self.has_trials:
            return summary_of(self.last_trials, self.last_criteria)
        return self.summaries_at(self.iterations[-1])[0] if len(self.runs) == 1 else None

    def recorded_at(self, iteration: int) -> list[RecordedTest]:
        """Return the tests after so many training iterations of the runs whose bags are there."""
        tests = [test for run in self.runs if run.bag is not None for test in run.recorded.tests]
        return [test for test in tests if test.trials.training_iteration == iteration]


def groups_of(runs: Sequence[Run]) -> list[Group]:
    """Return the runs by what they have in common, M before M_C, then by lambda.

    Raises InputError for runs that belong together and have no test in common.
    """
    by_common = _by_common(runs)
    keys = sorted(by_common, key=lambda key: (key.model != "M", key.model, key.weight))
    groups = []
    for key in keys:
        members = tuple(by_common[key])
        alike = [other for other in keys if other.model == key.model]
        own = differences(key, alike)
        name = ", ".join([key.model, *[f"lambda {key.weight:g} / W"] * bool(key.weight), *own])
        group = Group(
            name,
            _label(key, _shown_profile(key, keys, own) + own, len(members)),
            (alike.index(key), len(alike)),
            key,
            members,
        )
        if not group.iterations:
            names = ", ".join(str(run.directory) for run in members)
            raise InputError(f"{names}: expected a test after as many iterations in each, got none")
        groups.append(group)
    return groups


def _label(key: Common, own: Sequence[str], n_runs: int) -> str:
    names = {"M": "model M", "M_C": r"model M$_C$"}
    weight = [rf"$\lambda$ = {key.weight:.3g} / W"] * bool(key.weight)
    settings = textwrap.shorten(", ".join(own), _LONGEST_LABEL, placeholder=" ...")
    count = f"n = {n_runs} seed{'s' if n_runs > 1 else ''}"
    return ", ".join(filter(None, [names.get(key.model, key.model), *weight, settings, count]))


def _shown_profile(key: Common, keys: Sequence[Common], own: Sequence[str]) -> list[str]:
    """Return the profile's name where models differ in it: then not in lambda alone."""
    profiles = [dict(other.settings).get(_PROFILE) for other in keys]
    profile = dict(key.settings).get(_PROFILE)
    named = _named(_PROFILE, profile or "")
    return [named] if profile and len({*profiles}) > 1 and named not in own else []


def held_back(runs: Sequence[Run]) -> list[Run]:
    """Return the unfinished runs that would be pooled with finished ones.

    A group shows the tests that all its runs have made, so they would hold the others back.
    """
    return [
        run
        for members in _by_common(runs).values()
        if any(member.is_finished for member in members)
        for run in members
        if not run.is_finished
    ]


def common_of(runs: Sequence[Run]) -> list[Common]:
    """Return what each run has in common: the same for those that differ in their seeds alone.

    Runs that each have a seed and pictures of their own are alike. Where a seed has been used with
    several pictures, those are compared.
    """
    keys = [_common(run) for run in runs]
    seeds: dict[Common, set[int]] = {}
    for run, key in zip(runs, keys, strict=True):
        seeds.setdefault(key, set()).add(run.seed)
    families: dict[Common, dict[Common, set[int]]] = {}
    for key, of_key in seeds.items():
        if len(of_key) == 1:
            families.setdefault(_with_own_pictures(key), {})[key] = of_key
    pooled_as = {
        key: family
        for family, members in families.items()
        if 1 < len(members) == len(set.union(*members.values()))
        for key in members
    }
    return [pooled_as.get(key, key) for key in keys]


def _with_own_pictures(key: Common) -> Common:
    others = {(name, value) for name, value in key.settings if name != _PICTURES_SEED}
    return replace(key, settings=frozenset({*others, (_PICTURES_SEED, _OF_EACH)}))


def _by_common(runs: Sequence[Run]) -> dict[Common, list[Run]]:
    found: dict[Common, list[Run]] = {}
    for run, key in zip(runs, common_of(runs), strict=True):
        found.setdefault(key, []).append(run)
    return found


def _common(run: Run) -> Common:
    parameters = run.configuration
    if parameters.keys() >= DEFAULTS.keys():
        # What is not there is the default; the parameters of a replaced node stay as they are.
        with contextlib.suppress(InputError):
            parameters = completed(parameters)
    settings = {
        (key, str(value))
        for key, value in by_key(parameters).items()
        if key.partition(".")[2] not in _NO_SETTINGS and not key.startswith(_NO_PART)
    }
    settings |= {(f"{RUN_SECTION}.{n}", str(run.about[n])) for n in _COURSE if n in run.about}
    return Common(run.model, run.metabolic_cost_weight, run.n_iterations, frozenset(settings))


def differences(key: Common, others: Sequence[Common]) -> list[str]:
    """Return how a group differs from others, lambda aside: each setting with its value.

    others: what each of them has in common, its own included. Profiles stand for the settings that
    they make.
    """
    length = [f"{key.n_iterations:,} iterations"] * (len({of.n_iterations for of in others}) > 1)
    own, profile = dict(key.settings), dict(key.settings).get(_PROFILE)
    names = _varied(others)
    if _PROFILE in names:
        of_profile = [other for other in others if (_PROFILE, profile) in other.settings]
        profiles = {value for other in others for name, value in other.settings if name == _PROFILE}
        names -= set().union(*map(_made_by, profiles)) - _varied(of_profile)
    first = [name for name in (_STIMULI, _PROFILE) if name in names]
    return length + [
        _named(name, own[name]) for name in [*first, *sorted(names - {*first})] if name in own
    ]


def _varied(groups: Sequence[Common]) -> set[str]:
    """Return the names of the settings in which groups differ."""
    all_have = frozenset.intersection(*(group.settings for group in groups))
    return {name for group in groups for name, _ in group.settings - all_have}


def _made_by(profile: str) -> set[str]:
    """Return the settings that a profile makes: of one that is no more all may be its."""
    try:
        return {"task.schedule", *by_key(read_profile(profile).settings)} if profile else set()
    except InputError:
        return {*by_key(DEFAULTS)}


def _named(name: str, value: str) -> str:
    if name == _STIMULI:
        return f"{Path(value).name or 'generated'} stimuli"
    if name == _PICTURES_SEED:
        return f"stimuli {value if value == _OF_EACH else f'of seed {value}'}"
    return f"{name.rpartition('.')[2]} {value or 'none'}"
