"""The command line of run_experiment.sh, and what --set says, there and in evaluate.sh."""

import argparse
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, TypeVar

from experiment_manager.config import MODELS
from experiment_manager.live.address import Address
from experiment_manager.preparation.profiles import profile_names
from experiment_manager.preparation.request import OPTIONS, SCHEDULE, RunRequest, check_key
from experiment_manager.preparation.written_values import (
    whole_number,
    whole_numbers,
)
from experiment_manager.supervision.processes import MANAGER, PACKAGES
from lockstep import InputError
from lockstep.command_line import CommandLine
from lockstep.yaml_text import load_yaml
from sparse_coder.config import DEFAULT_METABOLIC_COST_WEIGHTS

Value = TypeVar("Value")


# Nodes that may run on another machine: all except the recorder.
MOVABLE_NODES = tuple(node for node in PACKAGES if node != MANAGER)


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


def parser() -> argparse.ArgumentParser:
    """Return the command line of run_experiment.sh."""
    line = CommandLine(
        prog="run_experiment.sh",
        description="Train and test active binocular vision. Without arguments: a demonstration "
        "that learns vergence and reciprocal innervation in 50,000 iterations.",
    )
    _add_settings(line)
    _add_tests(line)
    _add_price(line)
    _add_directories(line)
    _add_ways_to_run(line)
    return line


def _add_settings(line: argparse.ArgumentParser) -> None:
    group = line.add_argument_group("what to learn")
    group.add_argument(
        "--profile",
        metavar="NAME",
        help=f"named settings: {', '.join(profile_names())} (default: paper if"
        " --model or --iterations is given, otherwise demonstration)",
    )
    group.add_argument(
        "--model", choices=MODELS, help="M: no price on energy; M_C: a price on energy"
    )
    group.add_argument(
        "--iterations",
        type=_argument(whole_number),
        metavar="N",
        help="training iterations, for example 1e6; with --branch, including those of that run",
    )
    group.add_argument(
        "--schedule-delay",
        type=_argument(whole_number),
        metavar="N",
        help="training iterations by which the profile's schedule is delayed",
    )
    group.add_argument("--seed", type=_argument(whole_number), metavar="S", help="default: 1")
    group.add_argument(
        "--stimuli",
        type=Path,
        metavar="DIR",
        help="use these images: DIR/train and DIR/test, or all in DIR, split by seed (default:"
        " generated stimuli)",
    )
    group.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="SECTION.NAME=VALUE",
        help="set anything that list_parameters.sh lists; may be repeated",
    )


def _add_tests(line: argparse.ArgumentParser) -> None:
    group = line.add_argument_group("tests")
    group.add_argument(
        "--tests",
        type=_argument(whole_numbers),
        metavar="N,N,...",
        help="training iterations before each test; a test at the end is always made",
    )
    group.add_argument(
        "--test-stimuli",
        type=_argument(whole_number),
        metavar="K",
        help="stimuli of each test; a test has 39 trials of 20 iterations per stimulus (42 with a"
        " command for each muscle)",
    )


def _add_price(line: argparse.ArgumentParser) -> None:
    group = line.add_argument_group("price of energy")
    group.add_argument(
        "--lambda",
        dest="metabolic_cost_weight",
        type=float,
        metavar="L",
        help="price of energy in the reward, 1/W (default for M_C: "
        f"{DEFAULT_METABOLIC_COST_WEIGHTS['k17']}; with anatomical eyes "
        f"{DEFAULT_METABOLIC_COST_WEIGHTS['anatomical']})",
    )


def _add_directories(line: argparse.ArgumentParser) -> None:
    group = line.add_argument_group("where to write, what to continue")
    group.add_argument("--out", type=Path, metavar="DIR", help="run directory (default: runs/...)")
    group.add_argument(
        "--resume",
        type=Path,
        metavar="DIR",
        help="continue an interrupted run with its own settings",
    )
    group.add_argument(
        "--extend",
        type=_argument(whole_number),
        metavar="N",
        help="with --resume: N more training iterations; learning rates that fall until the end of"
        " training then fall until the new end",
    )
    group.add_argument(
        "--branch",
        metavar="RUN[@ITERATION]",
        help="start a new run from the newest checkpoint of RUN, or from the one at ITERATION, with"
        " the settings of RUN except those given here",
    )


def _add_ways_to_run(line: argparse.ArgumentParser) -> None:
    group = line.add_argument_group("how to run it")
    group.add_argument(
        "--in-process",
        action="store_true",
        help="make the run in one process on one core, without nodes; its numbers are the same",
    )
    group.add_argument(
        "--elsewhere",
        default=(),
        type=_nodes,
        metavar="NODE,...",
        help="nodes that you start yourself on another machine, any of "
        f"{', '.join(MOVABLE_NODES)}; see docs/reliability.md",
    )
    group.add_argument(
        "--live",
        nargs="?",
        const=Address(),
        type=Address.of,
        metavar="HOST:PORT",
        help="show the run in Lichtblick or Foxglove; without HOST only viewers on this machine can"
        f" connect (default: {Address()})",
    )


def _argument(read: Callable[[str], Value]) -> Callable[[str], Value]:
    """Return a reader of a text whose errors argparse shows as they are."""

    def argument(text: str) -> Value:
        try:
            return read(text)
        except InputError as error:
            raise argparse.ArgumentTypeError(str(error)) from error

    return argument


def _nodes(text: str) -> tuple[str, ...]:
    nodes = tuple(dict.fromkeys(text.split(",")))
    if unknown := [node for node in nodes if node not in MOVABLE_NODES]:
        raise argparse.ArgumentTypeError(
            f"expected some of {', '.join(MOVABLE_NODES)}, got {unknown[0]!r}"
        )
    return nodes


def _read_setting(text: str) -> tuple[str, Any]:
    key, equals, value = text.partition("=")
    if key == SCHEDULE:
        return key, value  # a parameter that is YAML itself
    if not equals:
        raise InputError(f"--set: expected SECTION.NAME=VALUE, got {text!r}")
    check_key(key, "--set")
    try:
        return key, load_yaml(value)
    except InputError as error:
        raise InputError(f"--set {text}: {error}") from error


def _shown(value: Any) -> str:
    if isinstance(value, tuple):
        return ",".join(map(str, value))
    return f"{value:g}" if isinstance(value, float) else str(value)
