"""What command lines ask for: a run, or other eyes in a test."""

import argparse
from collections.abc import Sequence
from typing import Any

from active_binocular_vision.command_lines.run import parser
from experiment_manager.preparation.request import OPTIONS, SCHEDULE, RunRequest, check_key
from experiment_manager.sections import DEFAULTS
from lockstep import InputError
from lockstep.written.yaml_text import load_yaml


def arguments(argv: Sequence[str] | None) -> argparse.Namespace:
    """Return the parsed command line; exits with 2 and one line when it cannot be parsed."""
    return parser().parse_args(argv)


def request_of(options: argparse.Namespace) -> RunRequest:
    """Return what a parsed command line asks a run to be.

    Raises InputError for a --set that cannot be read, and for two that contradict each other.
    """
    overrides: dict[str, Any] = {}
    names: dict[str, str] = {}
    for text in options.set:
        key, value = _read_setting(text)
        if key in overrides and overrides[key] != value:
            raise InputError(f"{names[key]} and --set {text}: expected one value of {key}")
        overrides[key] = value
        names.setdefault(key, f"--set {text}")
    values = {name: getattr(options, name) for name in OPTIONS}
    for name, value in values.items():
        if value is not None:
            names[name] = f"--{OPTIONS[name]} {_shown(value)}"
    if options.stimuli is not None:
        values["stimuli"] = str(options.stimuli.resolve())
    return RunRequest(**values, overrides=overrides, names=names)


def plant_settings(texts: Sequence[str]) -> dict[str, Any]:
    """Return what eyes.NAME=VALUE say, by the plant's dotted names.

    Raises InputError for other sections, and for a name given twice.
    """
    settings: dict[str, Any] = {}
    for text in texts:
        key, value = _read_setting(text)
        section, _, name = key.partition(".")
        if section != "eyes" or name in settings:
            raise InputError(
                f"--set: expected each eyes.NAME=VALUE of this test once, got {text!r}"
            )
        settings[name] = value
    return settings


def _read_setting(text: str) -> tuple[str, Any]:
    key, equals, value = text.partition("=")
    if not equals:
        raise InputError(f"--set: expected SECTION.NAME=VALUE, got {text!r}")
    check_key(key, "--set")
    section, _, name = key.partition(".")
    # A text needs no quotes, even where YAML would read 2024 or cut off a comment.
    if isinstance(DEFAULTS[section][name], str) and (
        key == SCHEDULE or not value.startswith(("'", '"'))
    ):
        return key, value
    try:
        return key, load_yaml(value)
    except InputError as error:
        raise InputError(f"--set {text}: {error}") from error


def _shown(value: Any) -> str:
    if isinstance(value, tuple):
        return ",".join(map(str, value))
    return f"{value:g}" if isinstance(value, float) else str(value)
