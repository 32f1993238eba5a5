"""A sweep: options for all runs, axes in which they differ, and the runs, its cells."""

import argparse
import contextlib
import io
import itertools
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from experiment_manager.preparation.command_line import arguments
from experiment_manager.preparation.configuration import configuration_of
from experiment_manager.run.config_file import CONFIG_CLASSES, Configuration
from lockstep.errors import InputError
from lockstep.nearest import did_you_mean

SWEEP_FILE = "sweep.yaml"
# Those of run_experiment.sh that say what a run is; any NODE.PARAMETER besides.
OPTIONS = (
    "profile",
    "model",
    "iterations",
    "seed",
    "stimuli",
    "lambda",
    "lambda-share",
    "tests",
    "test-stimuli",
)
_KEYS = ("description", "options", "axes")
_NOT_IN_NAMES = re.compile(r"[^A-Za-z0-9._+-]+")


@dataclass(frozen=True)
class Cell:
    """One run of a sweep.

    name: of its directory, from what it does not share; line: the command line of
    run_experiment.sh without --out.
    """

    name: str
    line: tuple[str, ...]

    def options(self) -> argparse.Namespace:
        """Return the parsed command line; raises InputError when it cannot be parsed."""
        said = io.StringIO()
        try:
            with contextlib.redirect_stderr(said):
                return arguments(self.line)
        except SystemExit as error:
            *_, reason = said.getvalue().splitlines()
            raise InputError(f"{self.name}: {reason.partition('error: ')[2]}") from error

    def configuration(self, commit: str) -> Configuration:
        """Return the parameters of all nodes; raises InputError, naming the cell."""
        try:
            return configuration_of(self.options(), commit)
        except InputError as error:
            raise InputError(f"{self.name}: {error}") from error


@dataclass(frozen=True)
class Sweep:
    """options: for all runs, {name: value}; axes: {name: values}, each value in a run of its own.

    Names are options of run_experiment.sh without dashes, and NODE.PARAMETER.
    Raises InputError for an unknown name, one that is in both, an axis without values, and two
    runs of one name.
    """

    options: Mapping[str, Any]
    axes: Mapping[str, Sequence[Any]]
    description: str = ""

    def __post_init__(self) -> None:
        """Check names and axes; what values may be is checked with each cell's configuration."""
        for part, names in (("options", self.options), ("axes", self.axes)):
            for name in names:
                _check_name(part, name)
        if both := [name for name in self.axes if name in self.options]:
            raise InputError(f"{both[0]}: expected it among the options or the axes, got both")
        if not self.axes:
            raise InputError(f"axes: expected one at least, such as seed: [1, 2], got {self.axes}")
        for name, values in self.axes.items():
            if not isinstance(values, list) or not values:
                raise InputError(f"axes: {name}: expected a list of values, got {values!r}")
        cells = [cell.name for cell in self.cells()]
        if doubled := [name for name in cells if cells.count(name) > 1]:
            raise InputError(
                f"axes: expected a name of its own for each run, got {doubled[0]} twice"
            )

    def cells(self) -> list[Cell]:
        """Return all combinations of the axes' values, the last axis fastest."""
        return [
            Cell(self._name(values), self._line(values))
            for values in itertools.product(*self.axes.values())
        ]

    def _name(self, values: Sequence[Any]) -> str:
        last_parts = [axis.rpartition(".")[2] for axis in self.axes]
        short = [
            last if last_parts.count(last) == 1 else axis
            for axis, last in zip(self.axes, last_parts, strict=True)
        ]
        parts = (f"{axis}_{_shown(value)}" for axis, value in zip(short, values, strict=True))
        return _NOT_IN_NAMES.sub("_", "-".join(parts))

    def _line(self, values: Sequence[Any]) -> tuple[str, ...]:
        given = {**self.options, **dict(zip(self.axes, values, strict=True))}
        words: list[str] = []
        for name, value in given.items():
            if name in OPTIONS:
                words += [f"--{name}", _shown(value)]
            else:
                words += ["--set", f"{name}={_as_json(name, value)}"]
        return tuple(words)

    def text(self) -> str:
        """Return the sweep as a YAML file has it."""
        about = {"description": self.description} if self.description else {}
        document = {**about, "options": dict(self.options), "axes": dict(self.axes)}
        return yaml.safe_dump(document, sort_keys=False)


def read_sweep(path: Path, stimuli: Path | None = None) -> Sweep:
    """Return the sweep of a YAML file; stimuli: a directory of images, one more option for all.

    Raises InputError for a file that is none, naming it.
    """
    try:
        document = yaml.safe_load(path.read_text())
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise InputError(f"{path}: expected a sweep as YAML: {error}") from error
    if not isinstance(document, dict):
        raise InputError(f"{path}: expected a sweep with axes, got {type(document).__name__}")
    if unknown := [key for key in document if key not in _KEYS]:
        raise InputError(f"{path}: expected {', '.join(_KEYS)}, got {unknown[0]!r}")
    options, axes = (document.get(key) or {} for key in ("options", "axes"))
    for part, names in (("options", options), ("axes", axes)):
        if not isinstance(names, dict) or not all(isinstance(name, str) for name in names):
            raise InputError(f"{path}: {part}: expected names and values, got {names!r}")
    if stimuli is not None:
        options = options | {"stimuli": str(stimuli)}
    # The directory of the sweep may be used from elsewhere.
    for name in ("stimuli", "eye_plant.stimuli.directory"):
        if name in options:
            options[name] = _absolute(options[name])
        if isinstance(axes.get(name), list):
            axes[name] = [_absolute(value) for value in axes[name]]
    try:
        return Sweep(options, axes, str(document.get("description", "")))
    except InputError as error:
        raise InputError(f"{path}: {error}") from error


def _absolute(directory: Any) -> Any:
    """Return the absolute path of a directory; "" is that of generated stimuli."""
    return str(Path(directory).resolve()) if isinstance(directory, str) and directory else directory


def _check_name(part: str, name: str) -> None:
    if name in OPTIONS or name.partition(".")[0] in CONFIG_CLASSES:
        return
    raise InputError(
        f"{part}: expected NODE.PARAMETER or one of {', '.join(OPTIONS)}, got {name!r}"
        + did_you_mean(name, (*OPTIONS, *CONFIG_CLASSES))
    )


def _as_json(name: str, value: Any) -> str:
    try:
        return json.dumps(value)
    except TypeError as error:  # YAML takes 2024-01-01 for a date
        kind = type(value).__name__
        raise InputError(
            f"{name}: expected numbers, texts, lists or true and false, got the {kind} {value}; "
            "a text may stand in quotes"
        ) from error


def _shown(value: Any) -> str:
    return ",".join(map(_shown, value)) if isinstance(value, list) else str(value)
