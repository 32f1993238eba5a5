"""Named sets of settings: a YAML file each, in the package's folder `profiles`.

description: one line for people
settings: {NODE: {parameter: value}}
schedule: [{at: TRAINING_ITERATION, set: {NODE.PARAMETER: value}}]    may be left out
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib import resources
from importlib.resources.abc import Traversable
from typing import Any

import yaml

from lockstep.errors import InputError
from lockstep.nearest import nearest

_SUFFIX = ".yaml"
_NEEDED, _KEYS = {"description", "settings"}, {"description", "settings", "schedule"}


@dataclass(frozen=True)
class Change:
    """What a schedule changes: from training iteration `at` on, {NODE.PARAMETER: value}."""

    at: int
    settings: Mapping[str, Any]


@dataclass(frozen=True)
class Profile:
    """A named set of settings.

    settings: by node, then by parameter; what is not named keeps the paper's default. schedule: in
    the order of its iterations.
    """

    name: str
    description: str
    settings: Mapping[str, Mapping[str, Any]]
    schedule: tuple[Change, ...]


def profile_names() -> list[str]:
    """Return the names of all profiles in order; those in a folder have it before a slash."""
    return sorted(_files())


def read_profile(name: str) -> Profile:
    """Return a profile; InputError for an unknown name and for a file that is no profile."""
    files = _files()
    if name not in files:
        near = nearest(name, files)
        raise InputError(
            f"profile: expected one of {', '.join(sorted(files))}, got {name!r}"
            + (f"; did you mean {' or '.join(near)}?" if near else "")
        )
    return parse_profile(name, files[name].read_text())


def parse_profile(name: str, text: str) -> Profile:
    """Return the profile that a YAML text holds; InputError when it is none."""
    try:
        document = yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise InputError(f"profile {name}: expected YAML: {error}") from error
    if not isinstance(document, dict) or not _NEEDED <= set(document) <= _KEYS:
        got = ", ".join(map(str, document)) if isinstance(document, dict) else repr(document)
        raise InputError(
            f"profile {name}: expected the keys description, settings and perhaps schedule, "
            f"got {got}"
        )
    description = document["description"]
    if not isinstance(description, str) or not description:
        raise InputError(f"profile {name}: expected a description in words, got {description!r}")
    settings = document["settings"]
    if not isinstance(settings, dict) or not all(isinstance(v, dict) for v in settings.values()):
        raise InputError(
            f"profile {name}: expected settings as {{NODE: {{parameter: value}}}}, got {settings!r}"
        )
    return Profile(name, description, settings, _schedule(name, document.get("schedule") or []))


def _schedule(name: str, entries: Any) -> tuple[Change, ...]:
    if not isinstance(entries, list):
        raise InputError(f"profile {name}: expected a list as schedule, got {entries!r}")
    changes = [_change(name, entry) for entry in entries]
    if [change.at for change in changes] != sorted({change.at for change in changes}):
        raise InputError(f"profile {name}: expected a schedule with growing iterations")
    return tuple(changes)


def _change(name: str, entry: Any) -> Change:
    if (
        not isinstance(entry, dict)
        or set(entry) != {"at", "set"}
        or type(entry["at"]) is not int
        or entry["at"] < 0
        or not isinstance(entry["set"], dict)
        or not all(isinstance(key, str) and "." in key for key in entry["set"])
    ):
        raise InputError(
            f"profile {name}: expected {{at: ITERATION, set: {{NODE.PARAMETER: value}}}} "
            f"in its schedule, got {entry!r}"
        )
    return Change(entry["at"], entry["set"])


def _files() -> dict[str, Traversable]:
    folder = resources.files("experiment_manager") / "profiles"
    return dict(_files_in(folder, ""))


def _files_in(folder: Traversable, prefix: str) -> Iterator[tuple[str, Traversable]]:
    for entry in folder.iterdir():
        if entry.is_dir():
            yield from _files_in(entry, f"{prefix}{entry.name}/")
        elif entry.name.endswith(_SUFFIX):
            yield prefix + entry.name.removesuffix(_SUFFIX), entry
