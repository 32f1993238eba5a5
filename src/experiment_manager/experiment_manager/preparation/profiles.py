"""Named sets of settings: a YAML file each, in the package's folder `profiles`.

description: one line for people
settings: {SECTION: {name: value}}
base: NAME    of a profile whose settings hold where this one has none; may be left out
schedule: [{at: TRAINING_ITERATION, set: {eyes.NAME: value}}]    may be left out
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from experiment_manager.plant_changes import Schedule, parse_schedule
from experiment_manager.preparation.profile_paths import profile_files
from lockstep import InputError
from lockstep.written.nearest import unknown
from lockstep.written.yaml_text import load_yaml

_NEEDED, _KEYS = {"description", "settings"}, {"description", "settings", "base", "schedule"}


@dataclass(frozen=True)
class Profile:
    """A named set of settings.

    settings: by section, then by name; what is not named keeps the paper's default.
    schedule: what changes in the course of the run.
    """

    name: str
    description: str
    settings: Mapping[str, Mapping[str, Any]]
    schedule: Schedule


def read_profile(name: str) -> Profile:
    """Return a profile; InputError for an unknown name and for a file that is no profile."""
    files = profile_files()
    if name not in files:
        raise InputError(f"profile: {unknown(name, sorted(files))}")
    return parse_profile(name, files[name].read_text())


def parse_profile(name: str, text: str) -> Profile:
    """Return the profile that a YAML text holds; InputError when it is none."""
    try:
        document = load_yaml(text)
    except InputError as error:
        raise InputError(f"profile {name}: {error}") from error
    if not isinstance(document, dict) or not _NEEDED <= set(document) <= _KEYS:
        got = ", ".join(map(str, document)) if isinstance(document, dict) else repr(document)
        raise InputError(
            f"profile {name}: expected the keys description, settings and perhaps base and "
            f"schedule, got {got}"
        )
    description = document["description"]
    if not isinstance(description, str) or not description:
        raise InputError(f"profile {name}: expected a description in words, got {description!r}")
    settings = document["settings"]
    if not isinstance(settings, dict) or not all(isinstance(v, dict) for v in settings.values()):
        raise InputError(
            f"profile {name}: expected settings as {{SECTION: {{name: value}}}}, got {settings!r}"
        )
    base = document.get("base")
    if base is not None:
        settings = _over(read_profile(str(base)), settings)
    try:
        schedule = parse_schedule(document.get("schedule") or [])
    except InputError as error:
        raise InputError(f"profile {name}: {error}") from error
    return Profile(name, description, settings, schedule)


def _over(base: Profile, settings: Mapping[str, Mapping[str, Any]]) -> dict[str, dict[str, Any]]:
    """Return a base's settings with others above them; a schedule is each profile's own."""
    if base.schedule.changes:
        raise InputError(f"profile {base.name}: expected a base without a schedule")
    sections = {**base.settings, **settings}
    return {s: {**base.settings.get(s, {}), **settings.get(s, {})} for s in sections}
