"""What a new run is asked to be, whether on a command line, in a sweep's file or by Gymnasium."""

import json
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from experiment_manager.preparation.controls import CONTROLS
from experiment_manager.sections import DEFAULTS, SECTIONS
from lockstep import InputError
from lockstep.task import MODELS
from lockstep.written.nearest import did_you_mean, unknown

# Keys, SECTION.NAME, of what has a name of its own in a request.
MODEL = "experiment_manager.model"
ITERATIONS = "task.n_training_iterations"
TESTS = "experiment_manager.test_iterations"
TEST_STIMULI = "experiment_manager.n_stimuli_per_test"
WEIGHT = "task.metabolic_cost_weight"
SCHEDULE = "task.schedule"
RULE, OWN_RULE = "vergence_rl.learning_rule", "vergence_rl.own_rule"
_KEYS = {
    "model": MODEL,
    "iterations": ITERATIONS,
    "seed": "task.seed",
    "metabolic_cost_weight": WEIGHT,
    "tests": TESTS,
    "test_stimuli": TEST_STIMULI,
    "stimuli": "eye_plant.stimuli.directory",
}
# The option of abv run for each field, without its dashes; so a sweep's file names it.
OPTIONS = {
    "profile": "profile",
    "model": "model",
    "iterations": "iterations",
    "seed": "seed",
    "stimuli": "stimuli",
    "metabolic_cost_weight": "lambda",
    "tests": "tests",
    "test_stimuli": "test-stimuli",
    "schedule_delay": "schedule-delay",
    "control": "control",
}


@dataclass(frozen=True)
class Given:
    """A value that is asked of a setting, and how errors name it."""

    value: Any
    by: str


def check_key(key: str, by: str) -> None:
    """Raise InputError unless a key is SECTION.NAME of a known setting; by: how errors name it."""
    section, dot, name = key.partition(".")
    if not dot or section not in SECTIONS:
        raise InputError(
            f"{by}: expected SECTION.NAME with a section of {', '.join(SECTIONS)}, "
            f"got {key!r}{did_you_mean(section, SECTIONS)}"
        )
    if name not in DEFAULTS[section]:
        known = [f"{s}.{n}" for s, names in DEFAULTS.items() for n in names]
        raise InputError(f"{by}: expected a setting, got {key!r}{did_you_mean(key, known)}")


def absolute_rule(name: Any) -> Any:
    """Return a value of RULE, FILE.py:CLASS with an absolute path, for use from elsewhere."""
    return os.path.abspath(name) if isinstance(name, str) and ".py:" in name else name


@dataclass(frozen=True)
class RunRequest:
    """What a new run is asked to be; None leaves a value to the profile.

    profile: its name, None for the paper's if a model or iterations are given, else the
    demonstration's; model: M or M_C; iterations: of training; stimuli: directory of images, "" for
    generated ones; metabolic_cost_weight: lambda, 1/W; tests: training iterations before each test;
    test_stimuli: how many a test shows; schedule_delay: training iterations by which the profile's
    schedule is put off; control: a name of CONTROLS; overrides: {SECTION.NAME: value}.
    names: how errors name a field or a key of the overrides, where not by itself.
    Raises InputError for an unknown model or node, and a value that no parameter can have.
    """

    profile: str | None = None
    model: str | None = None
    iterations: int | None = None
    seed: int | None = None
    stimuli: str | None = None
    metabolic_cost_weight: float | None = None
    tests: tuple[int, ...] | None = None
    test_stimuli: int | None = None
    schedule_delay: int | None = None
    control: str | None = None
    overrides: Mapping[str, Any] = field(default_factory=dict)
    names: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Check the model and the overrides, and keep these as parameters have them."""
        if self.model is not None and self.model not in MODELS:
            raise InputError(
                f"{self.by('model')}: expected {' or '.join(MODELS)}, got {self.model!r}"
            )
        if self.control is not None and self.control not in CONTROLS:
            raise InputError(f"{self.by('control')}: {unknown(self.control, CONTROLS)}")
        for key in self.overrides:
            check_key(key, self.by(key))
        plain = {key: self._plain(key, value) for key, value in self.overrides.items()}
        object.__setattr__(self, "overrides", plain)

    def by(self, name: str) -> str:
        """Return how errors name the value of a field, or of a key of the overrides."""
        return self.names.get(name, name)

    def settings(self) -> dict[str, Given]:
        """Return what is asked of single parameters, by key, SECTION.NAME.

        Raises InputError where two values are asked of one.
        """
        given: dict[str, Given] = {}
        for key, setting in self._settings():
            before = given.setdefault(key, setting)
            if before is not setting and before.value != setting.value:
                raise InputError(f"{before.by} and {setting.by}: expected one value of {key}")
        return given

    def _settings(self) -> Iterator[tuple[str, Given]]:
        for name, key in _KEYS.items():
            value = getattr(self, name)
            if value is not None:
                value = list(value) if isinstance(value, tuple) else value
                yield key, Given(value, self.by(name))
        for key, value in CONTROLS[self.control].items() if self.control else ():
            yield key, Given(value, self.by("control"))
        for key, value in self.overrides.items():
            yield key, Given(value, self.by(key))

    def _plain(self, key: str, value: Any) -> Any:
        """Return a value as a parameter has it: of JSON's kinds."""
        try:
            text = json.dumps(value, default=_of_json)
        except TypeError as error:
            raise InputError(
                f"{self.by(key)}: expected numbers, texts, lists or true and false, got the "
                f"{type(value).__name__} {value}"
            ) from error
        if key in (SCHEDULE, OWN_RULE):
            return value if isinstance(value, str) else text  # a parameter that is YAML itself
        return absolute_rule(json.loads(text)) if key == RULE else json.loads(text)


def _of_json(value: Any) -> Any:
    """Return what JSON has instead of a path, or a number or array of NumPy; else a TypeError."""
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    raise TypeError(type(value))
