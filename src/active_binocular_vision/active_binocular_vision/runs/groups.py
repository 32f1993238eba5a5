"""Runs that belong together in a figure: those that differ in their seeds alone."""

import contextlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from active_binocular_vision.runs.finished_run import FinishedRun
from active_binocular_vision.runs.recorded import RecordedTest
from experiment_manager.measures.criteria import Criteria
from experiment_manager.measures.metrics import summary_of
from experiment_manager.measures.results import Summary
from experiment_manager.measures.trials import Trials, pooled
from experiment_manager.run.config_file import (
    FREE_TO_CHANGE,
    RUN_SECTION,
)
from experiment_manager.sections import DEFAULTS, completed
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
_NO_PARTS = (("eye_plant", "free_running"),)
# Of what a run is, the course that settings do not show.
_COURSE = ("branched_at_iteration", "extended_from")
_MOST_SETTINGS_NAMED = 2


@dataclass(frozen=True)
class Common:
    """What the runs of a group have in common; settings: all else, (name, value as text)."""

    model: str
    weight: float
    n_iterations: int
    settings: frozenset[tuple[str, str]]


@dataclass(frozen=True)
class Group:
    """Runs that differ in their seeds alone; their trials are pooled, as K17 does.

    Their pictures are the same, or each run has a seed and pictures of its own.

    name: model, and how it differs from other groups except in lambda, as text; label: for figures;
    rank: (i, n), the i-th of the n groups of its model.
    """

    name: str
    label: str
    rank: tuple[int, int]
    common: Common
    runs: tuple[FinishedRun, ...]

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
            made += [set(run.trials) for run in self.runs]
        return sorted(set.intersection(*made))

    @property
    def recorded_iterations(self) -> list[int]:
        """Those of `iterations` whose test is in a bag; a bag may begin at a later checkpoint."""
        return [iteration for iteration in self.iterations if self.recorded_at(iteration)]

    @property
    def has_trials(self) -> bool:
        """Whether the trials of all runs are known, and not their measures alone."""
        return all(run.trials for run in self.runs)

    def trials_at(self, iteration: int) -> Trials:
        """Return the trials of all runs after so many training iterations."""
        return pooled([run.trials[iteration] for run in self.runs])

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
        return [
            next(test for test in run.summaries if test.iteration == iteration) for run in self.runs
        ]

    @cached_property
    def last_summary(self) -> Summary | None:
        """The measures of the last common test, trials pooled; None where trials are not known."""
        if self.has_trials:
            return summary_of(self.last_trials, self.last_criteria)
        return self.summaries_at(self.iterations[-1])[0] if len(self.runs) == 1 else None

    def recorded_at(self, iteration: int) -> list[RecordedTest]:
        """Return the tests after so many training iterations of the runs whose bags are there."""
        return [
            test
            for run in self.runs
            if run.bag is not None
            for test in run.recorded.tests
            if test.trials.training_iteration == iteration
        ]


def groups_of(runs: Sequence[FinishedRun]) -> list[Group]:
    """Return the runs by what they have in common, M before M_C, then by lambda.

    Raises InputError for runs that belong together and have no test in common.
    """
    by_key = _by_key(runs)
    different = sorted(by_key, key=lambda key: (key.model != "M", key.model, key.weight))
    groups = []
    for key in different:
        members = tuple(by_key[key])
        same_model = [other for other in different if other.model == key.model]
        rank = (same_model.index(key), len(same_model))
        own = own_settings(key, same_model)
        name = ", ".join([key.model, *own])
        group = Group(name, _label(key, own, len(members)), rank, key, members)
        if not group.iterations:
            names = ", ".join(str(run.directory) for run in members)
            raise InputError(f"{names}: expected a test after as many iterations in each, got none")
        groups.append(group)
    return groups


def held_back(runs: Sequence[FinishedRun]) -> list[FinishedRun]:
    """Return the unfinished runs that would be pooled with finished ones.

    A group shows the tests that all its runs have made, so they would hold the others back.
    """
    return [
        run
        for members in _by_key(runs).values()
        if any(member.is_finished for member in members)
        for run in members
        if not run.is_finished
    ]


def common_of(runs: Sequence[FinishedRun]) -> list[Common]:
    """Return what each run has in common: the same for those that differ in their seeds alone."""
    keys = [_key(run) for run in runs]
    seeds: dict[Common, set[int]] = {}
    for run, key in zip(runs, keys, strict=True):
        seeds.setdefault(key, set()).add(run.seed)
    pooled_keys = _with_own_pictures(seeds)
    return [pooled_keys.get(key, key) for key in keys]


def _by_key(runs: Sequence[FinishedRun]) -> dict[Common, list[FinishedRun]]:
    by_key: dict[Common, list[FinishedRun]] = {}
    for run, key in zip(runs, common_of(runs), strict=True):
        by_key.setdefault(key, []).append(run)
    return by_key


def _with_own_pictures(seeds: Mapping[Common, set[int]]) -> dict[Common, Common]:
    """Return what the runs have in common that each have a seed and pictures of their own.

    seeds: of the runs on the same pictures. Where a seed has been used with several pictures, those
    are compared, not pooled.
    """
    families: dict[Common, list[Common]] = {}
    for key, of_key in seeds.items():
        if len(of_key) == 1:
            others = frozenset(s for s in key.settings if s[0] != _PICTURES_SEED)
            settings = others | {(_PICTURES_SEED, _OF_EACH)}
            families.setdefault(replace(key, settings=settings), []).append(key)
    return {
        key: family
        for family, keys in families.items()
        if 1 < len(keys) == len(set.union(*(seeds[key] for key in keys)))
        for key in keys
    }


def _key(run: FinishedRun) -> Common:
    parameters = run.configuration
    if parameters.keys() >= DEFAULTS.keys():
        # What is not there is the default; the parameters of a replaced node stay as they are.
        with contextlib.suppress(InputError):
            parameters = completed(parameters)
    settings = {
        (f"{node}.{name}", str(value))
        for node, values in parameters.items()
        for name, value in values.items()
        if name not in _NO_SETTINGS and (node, name.partition(".")[0]) not in _NO_PARTS
    }
    course = {
        (f"{RUN_SECTION}.{name}", str(run.about[name])) for name in _COURSE if name in run.about
    }
    return Common(
        run.model, run.metabolic_cost_weight, run.n_iterations, frozenset(settings | course)
    )


def _label(key: Common, own: Sequence[str], n_runs: int) -> str:
    names = {"M": "model M", "M_C": r"model M$_C$"}
    price = [rf"$\lambda$ = {key.weight:.3g} / W"] if key.weight else []
    count = f"{n_runs} run{'s' if n_runs > 1 else ''}"
    return ", ".join([names.get(key.model, key.model), *price, *own, count])


def own_settings(key: Common, same_model: Sequence[Common]) -> list[str]:
    """Return how a group differs from the others of its model, lambda aside.

    same_model: what each of these has in common, its own included.
    """
    lengths = {other.n_iterations for other in same_model}
    length = [f"{key.n_iterations:,} iterations"] if len(lengths) > 1 else []
    common = frozenset.intersection(*(other.settings for other in same_model))
    profile = [setting for setting in key.settings - common if setting[0] == _PROFILE]
    # A profile describes how it differs from others, not how its own runs differ.
    alike = [other for other in same_model if other.settings.issuperset(profile)]
    settings = key.settings - frozenset.intersection(*(other.settings for other in alike))
    stimuli = [setting for setting in key.settings - common if setting[0] == _STIMULI]
    more = sorted(settings.difference(profile, stimuli))[:_MOST_SETTINGS_NAMED]
    return length + [_named(*setting) for setting in (*stimuli, *profile, *more)]


def _named(name: str, value: str) -> str:
    if name == _STIMULI:
        return f"{Path(value).name or 'generated'} stimuli"
    if name == _PICTURES_SEED:
        return f"pictures {value if value == _OF_EACH else f'of seed {value}'}"
    return f"{name.rpartition('.')[2]} {value}"
