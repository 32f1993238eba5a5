"""The command line of `abv run`."""

import argparse
import textwrap
from collections.abc import Callable
from typing import TypeVar

from active_binocular_vision.command_lines.start import start
from experiment_manager.live.address import Address
from experiment_manager.nodes import MOVABLE_NODES
from experiment_manager.preparation.controls import CONTROLS
from experiment_manager.preparation.profile_paths import profile_files
from experiment_manager.preparation.written_values import whole_number, whole_numbers
from lockstep import InputError
from lockstep.task import DEFAULT_METABOLIC_COST_WEIGHTS, MODELS
from lockstep.written.command_line import CommandLine, WithLists, command
from lockstep.written.nearest import unknown
from lockstep.written.paths import written_path

Value = TypeVar("Value")


def parser() -> argparse.ArgumentParser:
    """Return the command line of `abv run`."""
    line = CommandLine(
        prog=command("run"),
        description="Train and test active binocular vision. Without arguments: a demonstration "
        "that learns vergence and reciprocal innervation in 75,000 iterations. Ctrl-C ends a run"
        " with a checkpoint and prints how to resume it.",
        epilog=f"profiles:\n{_profiles()}\n\nROS_DOMAIN_ID names the ROS domain (default: a free"
        " one, which the run prints, so that\nother tools can subscribe).",
        formatter_class=WithLists,
    )
    _add_settings(line)
    _add_tests(line)
    _add_lambda(line)
    _add_directories(line)
    _add_ways_to_run(line)
    return line


def _profiles() -> str:
    """Return the names of all profiles, each folder in a paragraph of its own."""
    folders: dict[str, list[str]] = {}
    for name in sorted(profile_files(), key=lambda name: ("/" in name, name)):
        folder, slash, _ = name.rpartition("/")
        folders.setdefault(folder + slash, []).append(name)
    return "\n".join(
        textwrap.fill(
            ", ".join(names), initial_indent="  ", subsequent_indent="    ", break_on_hyphens=False
        )
        for names in folders.values()
    )


def _add_settings(line: argparse.ArgumentParser) -> None:
    group = line.add_argument_group("what to learn")
    group.add_argument(
        "--profile",
        metavar="NAME",
        help="named settings, listed below (default: paper if --model or --iterations is given,"
        " otherwise demonstration)",
    )
    group.add_argument(
        "--model", choices=MODELS, help="M: the reward counts no energy; M_C: it counts energy"
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
    group.add_argument(
        "--control",
        metavar="NAME",
        help="leave one thing out, to compare: " + ", ".join(CONTROLS),
    )
    group.add_argument("--seed", type=_argument(whole_number), metavar="S", help="default: 1")
    group.add_argument(
        "--stimuli",
        type=written_path,
        metavar="DIR",
        help="use these images: DIR/train and DIR/test, or all in DIR, split by seed (default:"
        " generated stimuli)",
    )
    group.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="SECTION.NAME=VALUE",
        help="set anything that abv parameters lists; may be repeated",
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
        help="stimuli of each test; how many trials that makes, a run says at its start",
    )


def _add_lambda(line: argparse.ArgumentParser) -> None:
    group = line.add_argument_group("energy")
    group.add_argument(
        "--lambda",
        dest="metabolic_cost_weight",
        type=float,
        metavar="L",
        help="what a watt takes from the reward, 1/W (default: the profile's; with --model M_C"
        f" {DEFAULT_METABOLIC_COST_WEIGHTS['k17']}, with anatomical eyes"
        f" {DEFAULT_METABOLIC_COST_WEIGHTS['anatomical']})",
    )


def _add_directories(line: argparse.ArgumentParser) -> None:
    group = line.add_argument_group("where to write, what to continue")
    group.add_argument(
        "--out",
        type=written_path,
        metavar="DIR",
        help="run directory (default: runs/...)",
    )
    group.add_argument(
        "--resume",
        type=written_path,
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
        f"{', '.join(MOVABLE_NODES)}; see docs/how_to/two_machines.md",
    )
    group.add_argument(
        "--live",
        nargs="?",
        const=Address(),
        type=Address.of,
        metavar="HOST:PORT",
        help="watch the run in a browser, or, at HOST:PORT, in Lichtblick or Foxglove;"
        f" without HOST only on this machine (default: {Address()})",
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
    if wrong := [node for node in nodes if node not in MOVABLE_NODES]:
        raise argparse.ArgumentTypeError(unknown(wrong[0], MOVABLE_NODES))
    return nodes


def main() -> None:
    """Run the command line as this process."""
    start("run", parser)


if __name__ == "__main__":
    main()
