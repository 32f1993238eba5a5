"""Runs that belong together in a figure: those that differ in nothing but the seed."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from experiment_manager.measures.recorded_run import RecordedRun, RecordedTest

# K17's colours: M blue, M_C green. Lightness tells further groups of a model apart.
_COLOURS = {"M": ("#1f5fa8", "#6aa5e0", "#0c2f57"), "M_C": ("#2b8a3e", "#7cc68a", "#14451f")}
# The section of a configuration that says what the run is, and parameters that change no number
# that a figure shows: who made the run, where, how often it was saved, and when it was tested.
_ABOUT = "run"
_STIMULI = "eye_plant.stimuli.directory"
_NO_SETTINGS = (
    "seed",
    "metabolic_cost_weight",
    "model",
    "commit",
    "run_directory",
    "run_id",
    "resume",
    "supervised",
    "checkpoint_period_s",
    "keeps_tested_checkpoints",
    "gap_s",
    "pictures_every_n_episodes",
    "pictures_every_n_trials",
    "n_training_iterations",
    "protocol.n_training_iterations",
    "protocol.test_iterations",
)
# Parts of a node's parameters: the manager has the plant's mechanics once more, and a run's plant
# does not run freely.
_NO_PARTS = (("/**/experiment_manager", "mechanics"), ("/**/eye_plant", "free_running"))
_MOST_SETTINGS_NAMED = 2


@dataclass(frozen=True)
class Group:
    """Runs that differ in nothing but the seed; their trials are pooled, as K17 does.

    tests: per test the recorded tests of all runs, only where all runs have that test.
    """

    label: str
    colour: str
    model: str
    runs: tuple[RecordedRun, ...]

    @property
    def iterations(self) -> list[int]:
        """Training iterations before each test that all runs made, in order."""
        made = [{test.trials.training_iteration for test in run.tests} for run in self.runs]
        return sorted(set.intersection(*made))

    def tests_at(self, iteration: int) -> list[RecordedTest]:
        """Return each run's test after so many training iterations."""
        return [
            test
            for run in self.runs
            for test in run.tests
            if test.trials.training_iteration == iteration
        ]


@dataclass(frozen=True)
class _Key:
    """What the runs of a group have in common; settings: all else, (name, value as text)."""

    model: str
    weight: float
    n_iterations: int
    settings: frozenset[tuple[str, str]]


def groups_of(runs: Sequence[RecordedRun]) -> list[Group]:
    """Return the runs by what they have in common, M before M_C, in the order given."""
    keys = [_key(run) for run in runs]
    different = sorted(dict.fromkeys(keys), key=lambda key: (key.model != "M", key.model))
    found = []
    for key in different:
        members = tuple(run for run, its in zip(runs, keys, strict=True) if its == key)
        same_model = [other for other in different if other.model == key.model]
        shades = _COLOURS.get(key.model, ("#555555",))
        colour = shades[same_model.index(key) % len(shades)]
        found.append(Group(_label(key, same_model, len(members)), colour, key.model, members))
    return found


def _key(run: RecordedRun) -> _Key:
    document: dict[str, Any] = yaml.safe_load(run.configuration)
    settings = frozenset(
        (f"{section.removeprefix('/**/')}.{name}", str(value))
        for section, content in document.items()
        if section != _ABOUT
        for name, value in content["ros__parameters"].items()
        if name not in _NO_SETTINGS and (section, name.partition(".")[0]) not in _NO_PARTS
    )
    return _Key(run.model, run.metabolic_cost_weight, run.n_iterations, settings)


def _label(key: _Key, same_model: Sequence[_Key], n_runs: int) -> str:
    """Return a group's name: what tells it from the others of its model, and the number of runs."""
    names = {"M": r"$\mathcal{M}$", "M_C": r"$\mathcal{M}_C$"}
    parts = [names.get(key.model, key.model)]
    if key.weight:
        parts.append(rf"$\lambda$ = {key.weight:.3g}/W")
    if len({other.n_iterations for other in same_model}) > 1:
        parts.append(f"{key.n_iterations:,} iterations")
    common = frozenset.intersection(*(other.settings for other in same_model))
    own = sorted(key.settings - common, key=lambda setting: (setting[0] != _STIMULI, setting))
    parts += [_named(*setting) for setting in own[:_MOST_SETTINGS_NAMED]]
    parts.append(f"{n_runs} run{'s' if n_runs > 1 else ''}")
    return ", ".join(parts)


def _named(name: str, value: str) -> str:
    if name == _STIMULI:
        return f"{Path(value).name or 'generated'} stimuli"
    return f"{name.rpartition('.')[2]} {value}"
