"""A sweep: options for all runs, axes in which they differ, and the runs."""

import itertools
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from experiment_manager.preparation.request import OPTIONS, RULE, RunRequest, absolute_rule
from experiment_manager.preparation.written_values import number, whole_number, whole_numbers
from experiment_manager.sections import SECTIONS
from lockstep import InputError
from lockstep.written.nearest import did_you_mean
from lockstep.written.paths import written_path
from lockstep.written.yaml_text import dump_yaml, load_yaml

SWEEP_FILE = "sweep.yaml"
# By its name in the file, the field of a request; any SECTION.NAME besides.
_FIELDS = {name: field for field, name in OPTIONS.items()}
# How the text of a value is read; what is not here is a text.
_READERS: dict[str, Callable[[str], Any]] = {
    "iterations": whole_number,
    "seed": whole_number,
    "lambda": number,
    "tests": whole_numbers,
    "test-stimuli": whole_number,
    "schedule-delay": whole_number,
}
_DIRECTORIES = ("stimuli", "eye_plant.stimuli.directory")
_LONGEST_NAME = 255 - len(".log")  # a file's name has 255 bytes at most
_KEYS = ("description", "options", "axes")
_NOT_IN_NAMES = re.compile(r"[^A-Za-z0-9._+-]+")


@dataclass(frozen=True)
class Sweep:
    """options: for all runs, {name: value}; axes: {name: entries}, each entry in a run of its own.

    Names are options of abv run without dashes, and SECTION.NAME. An entry is a value,
    or {name: value} for several that belong together, that of the axis among them.
    Raises InputError for an unknown name, one that is set twice, an axis without entries, two runs
    of one name, and a value that cannot be read.
    """

    options: Mapping[str, Any]
    axes: Mapping[str, Sequence[Any]]
    description: str = ""

    def __post_init__(self) -> None:
        """Check names and axes; what values may be is checked with each run's configuration."""
        for name in self.options:
            _check_name("options", name)
        if not self.axes:
            raise InputError(f"axes: expected one at least, such as seed: [1, 2], got {self.axes}")
        set_by = dict.fromkeys(self.options, "options")
        for axis, entries in self.axes.items():
            for name in _names(axis, entries):
                if set_by.setdefault(name, axis) != axis:
                    raise InputError(
                        f"{name}: expected it in the options or in one axis, got it in "
                        f"{set_by[name]} and {axis}"
                    )
        self.runs()

    def runs(self) -> dict[str, RunRequest]:
        """Return what each run is asked to be, by its name, the last axis fastest.

        Runs are all combinations of the axes' entries; a name is also that of the directory.
        """
        settings = [[_settings(axis, e) for e in entries] for axis, entries in self.axes.items()]
        runs: dict[str, RunRequest] = {}
        for entries in itertools.product(*settings):
            name = self._name(entries)
            if len(name) > _LONGEST_NAME:
                raise InputError(
                    f"axes: expected names of runs up to {_LONGEST_NAME} characters, "
                    f"got {len(name)}: {name}"
                )
            if name in runs:
                raise InputError(f"axes: expected a name of its own for each run, got {name} twice")
            runs[name] = self._request(name, entries)
        return runs

    def _name(self, entries: Sequence[Mapping[str, Any]]) -> str:
        last_parts = [axis.rpartition(".")[2] for axis in self.axes]
        parts = [
            f"{last if last_parts.count(last) == 1 else axis}_{_shown(entry[axis])}"
            for axis, last, entry in zip(self.axes, last_parts, entries, strict=True)
        ]
        return _NOT_IN_NAMES.sub("_", "-".join(parts))

    def _request(self, name: str, entries: Sequence[Mapping[str, Any]]) -> RunRequest:
        given = dict(self.options)
        for entry in entries:
            given |= entry
        try:
            return RunRequest(
                **{_FIELDS[key]: _read(key, v) for key, v in given.items() if key in _FIELDS},
                overrides={key: v for key, v in given.items() if key not in _FIELDS},
                names=OPTIONS,
            )
        except InputError as error:
            raise InputError(f"{name}: {error}") from error

    def text(self) -> str:
        """Return the sweep as a YAML file has it."""
        about = {"description": self.description} if self.description else {}
        document = {**about, "options": dict(self.options), "axes": dict(self.axes)}
        return dump_yaml(document)


def read_sweep(path: Path, stimuli: Path | None = None) -> Sweep:
    """Return the sweep of a YAML file; stimuli: a directory of images, one more option for all.

    Raises InputError for a file that is none, naming it.
    """
    try:
        document = load_yaml(path.read_text())
    except (OSError, UnicodeDecodeError, InputError) as error:
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
    options, axes = (
        {name: _absolute(name, value) for name, value in names.items()} for names in (options, axes)
    )
    try:
        return Sweep(options, axes, str(document.get("description", "")))
    except InputError as error:
        raise InputError(f"{path}: {error}") from error


def _absolute(name: str, value: Any) -> Any:
    """Return a value, of a directory or a rule's file its absolute path, for use from elsewhere.

    "" is that of generated stimuli. value: of an option, or the entries of an axis.
    """
    if isinstance(value, dict):
        return {key: _absolute(key, inner) for key, inner in value.items()}
    if isinstance(value, list):
        return [_absolute(name, inner) for inner in value]
    if name == RULE:
        return absolute_rule(value)
    is_directory = name in _DIRECTORIES and isinstance(value, str) and value
    return str(written_path(value).resolve()) if is_directory else value


def _settings(axis: str, entry: Any) -> dict[str, Any]:
    """Return what an entry of an axis sets, by name."""
    return entry if isinstance(entry, dict) else {axis: entry}


def _names(axis: str, entries: Any) -> dict[str, Any]:
    """Return all names that an axis sets; raises InputError when it cannot be one."""
    _check_name("axes", axis)
    if not isinstance(entries, list) or not entries:
        raise InputError(f"axes: {axis}: expected a list of values, got {entries!r}")
    names: dict[str, Any] = {}
    for settings in (_settings(axis, entry) for entry in entries):
        names |= settings
        for name in settings:
            _check_name(f"axes: {axis}", name)
        if axis not in settings:
            raise InputError(
                f"axes: {axis}: expected {axis} among what each entry sets, got {settings}"
            )
    return names


def _check_name(part: str, name: Any) -> None:
    name = str(name)
    if name in _FIELDS or name.partition(".")[0] in SECTIONS:
        return
    raise InputError(
        f"{part}: expected SECTION.NAME or one of {', '.join(_FIELDS)}, got {name!r}"
        + did_you_mean(name, (*_FIELDS, *SECTIONS))
    )


def _read(name: str, value: Any) -> Any:
    try:
        return _READERS.get(name, str)(_shown(value))
    except InputError as error:
        raise InputError(f"{name}: {error}") from error


def _shown(value: Any) -> str:
    return ",".join(map(_shown, value)) if isinstance(value, list) else str(value)
