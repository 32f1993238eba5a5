"""Changes of the plant in the course of a run: treatment, patching, surgery, a disease.

A schedule is a list of {at: TRAINING_ITERATION, set: {eyes.PARAMETER: value}}, in YAML or JSON. A
change holds for the training episodes that begin at that iteration or later, and for the tests
after it: a test at that very iteration still finds the plant as it was.
"""

import itertools
import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from eye_plant import EyePlantConfig
from eye_plant.config import changeable_parameters, changed
from lockstep import InputError, build, flatten
from lockstep.wire.topics import TRAINING
from lockstep.written.nearest import did_you_mean
from lockstep.written.yaml_text import load_yaml

_EYES = "eyes."


@dataclass(frozen=True)
class Change:
    """What a schedule changes: from training iteration `at` on, {eyes.PARAMETER: value}."""

    at: int
    settings: Mapping[str, Any]

    def numbers(self) -> dict[str, float]:
        """Return the values as numbers by name, as the bag has them.

        A list has a number for each of its entries, NAME[0], NAME[1], ...; false is 0, true is 1.
        """
        numbers: dict[str, float] = {}
        for name, value in self.settings.items():
            if isinstance(value, list):
                numbers |= {f"{name}[{i}]": float(entry) for i, entry in enumerate(value)}
            else:
                numbers[name] = float(value)
        return numbers


@dataclass(frozen=True)
class Schedule:
    """The changes of a run, in the order of their iterations.

    The run is in stage k when k of them are in force.
    """

    changes: tuple[Change, ...] = ()

    def stage(self, phase: int, training_iteration: int) -> int:
        """Return how many changes are in force in an episode or trial.

        training_iteration: training iterations before it.
        """
        reached = training_iteration + (1 if phase == TRAINING else 0)
        return sum(change.at < reached for change in self.changes)

    def settings(self, stage: int) -> dict[str, Any]:
        """Return the plant's parameters that differ in a stage from those it was started with."""
        merged: dict[str, Any] = {}
        for change in self.changes[:stage]:
            merged |= change.settings
        return {name.removeprefix(_EYES): value for name, value in merged.items()}

    def plants(self, plant: EyePlantConfig) -> list[EyePlantConfig]:
        """Return the plant's configuration in each stage; plant: the one it is started with.

        Raises InputError naming the change that the plant refuses.
        """
        found = [plant]
        for stage, change in enumerate(self.changes, start=1):
            try:
                found.append(changed(plant, self.settings(stage)))
            except InputError as error:
                raise InputError(f"schedule, at {change.at}: {error}") from error
        return found

    def delayed(self, n_iterations: int) -> "Schedule":
        """Return the same changes, each so many training iterations later, 0 or more."""
        return Schedule(tuple(replace(c, at=c.at + n_iterations) for c in self.changes))

    def text(self) -> str:
        """Return the schedule as one line of JSON, "" for none; for `parse_schedule`."""
        if not self.changes:
            return ""
        return json.dumps([{"at": c.at, "set": dict(c.settings)} for c in self.changes])


def read_schedule(text: str) -> Schedule:
    """Return the schedule of a text in YAML or JSON; "" is none. Errors as for parse_schedule."""
    try:
        entries = load_yaml(text) if text else []
    except InputError as error:
        raise InputError(f"schedule: {error}") from error
    return parse_schedule(entries)


def parse_schedule(entries: Any) -> Schedule:
    """Return the schedule that a list of {at, set} holds.

    Raises InputError for anything else, iterations that do not grow, and names of parameters that
    the plant has not or cannot change.
    """
    if not isinstance(entries, list):
        raise InputError(f"schedule: expected a list of {{at, set}}, got {entries!r}")
    changes = tuple(_change(entry) for entry in entries)
    for before, after in itertools.pairwise(changes):
        if after.at <= before.at:
            raise InputError(
                f"schedule: expected increasing iterations, got {after.at} after {before.at}"
            )
    return Schedule(changes)


def _change(entry: Any) -> Change:
    if not isinstance(entry, dict) or set(entry) != {"at", "set"}:
        raise InputError(
            f"schedule: expected {{at: ITERATION, set: {{eyes.PARAMETER: value}}}}, got {entry!r}"
        )
    at, settings = entry["at"], entry["set"]
    if type(at) is not int or at < 1:
        raise InputError(
            f"schedule: expected a training iteration of 1 or more as `at` (values from the "
            f"start belong in the settings), got {at!r}"
        )
    if not isinstance(settings, dict) or not settings:
        raise InputError(
            f"schedule, at {at}: expected {{eyes.PARAMETER: value}} as `set`, got {settings!r}"
        )
    known = [f"{_EYES}{name}" for name in changeable_parameters()]
    for name in settings:
        if name not in known:
            raise InputError(
                f"schedule, at {at}: expected a setting of the eyes that may change during a run, "
                f"got {str(name)!r}{did_you_mean(str(name), known)}"
            )
    return Change(at, {name: _typed(at, name, value) for name, value in settings.items()})


def _typed(at: int, name: str, value: Any) -> Any:
    """Return a value as the plant has it: a whole number may stand for another one."""
    of_plant = name.removeprefix(_EYES)
    try:
        return flatten(build(EyePlantConfig, {of_plant: value}))[of_plant]
    except InputError as error:
        raise InputError(f"schedule, at {at}: {error}") from error


def check_places(schedule: Schedule, n_training_iterations: int, per_episode: int) -> None:
    """Raise InputError unless each change is reached, at the start of an episode.

    n_training_iterations: of the run; per_episode: of each training episode.
    """
    for change in schedule.changes:
        if change.at % per_episode or change.at >= n_training_iterations:
            raise InputError(
                f"schedule: expected a multiple of {per_episode} (iterations per episode) below "
                f"{n_training_iterations} (the run's iterations), got {change.at}"
            )
