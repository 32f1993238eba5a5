"""The command line of run_experiment.sh."""

import argparse
from collections.abc import Sequence
from pathlib import Path

from experiment_manager.experiment.config import MODELS
from experiment_manager.live.address import Address
from experiment_manager.preparation.profiles import profile_names
from lockstep.command_line import CommandLine

# Lambda of M_C, 1/W, by the eyes' parameter set: energy is 20 % of the reward over the first 5,000
# iterations on the generated stimuli, by which rule K17 chose its 0.035 (D7). Measured, seed 1, by
#   run_experiment.sh --profile paper --model M_C --lambda-share 0.2
# and, for the second, with --set eye_plant.mechanics.parameter_set=anatomical.
# k17: mean E 0.3711, mean C 1.4300 W, lambda 0.0649; anatomical, of real muscle masses: mean E
# 0.4082, mean C 0.0858 W, lambda 1.190.
DEFAULT_METABOLIC_COST_WEIGHTS = {"k17": 0.065, "anatomical": 1.19}
# Who may be on another machine than the supervisor: all but the one that records.
MOVABLE_NODES = ("eye_plant", "sparse_coder", "vergence_rl")


def arguments(argv: Sequence[str] | None) -> argparse.Namespace:
    """Return the parsed command line; exits with 2 and a usage line when it cannot be parsed."""
    return parser().parse_args(argv)


def parser() -> argparse.ArgumentParser:
    """Return the command line of run_experiment.sh."""
    line = CommandLine(
        prog="run_experiment.sh",
        description="Train and test active binocular vision. Without arguments: a demonstration "
        "that learns vergence in 50,000 iterations.",
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
        help=f"settings to begin with: {', '.join(profile_names())} (default:"
        " paper if --model or --iterations is given, else demonstration)",
    )
    group.add_argument("--model", choices=MODELS, help="M: vergence; M_C: with a price on energy")
    group.add_argument("--iterations", type=_whole, metavar="N", help="training iterations, as 1e6")
    group.add_argument("--seed", type=_whole, metavar="S", help="default: 1")
    group.add_argument(
        "--stimuli",
        type=Path,
        metavar="DIR",
        help="images instead of generated ones: train/ and test/ inside, or one directory",
    )
    group.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="NODE.PARAMETER=VALUE",
        help="any parameter of any node; repeatable",
    )


def _add_tests(line: argparse.ArgumentParser) -> None:
    group = line.add_argument_group("tests")
    group.add_argument(
        "--tests",
        type=_wholes,
        metavar="N,N,...",
        help="training iterations before each test; one at the end is always made",
    )
    group.add_argument(
        "--test-stimuli",
        type=_whole,
        metavar="K",
        help="stimuli of each test; a test has 39 trials of 20 iterations for each",
    )


def _add_price(line: argparse.ArgumentParser) -> None:
    group = line.add_argument_group("price of energy")
    group.add_argument(
        "--lambda",
        dest="weight",
        type=float,
        metavar="L",
        help="price of energy in the reward, 1/W (default for M_C: "
        f"{DEFAULT_METABOLIC_COST_WEIGHTS['k17']}; with anatomical eyes "
        f"{DEFAULT_METABOLIC_COST_WEIGHTS['anatomical']})",
    )
    group.add_argument(
        "--lambda-share",
        dest="share",
        type=float,
        metavar="S",
        help="choose lambda so that energy is this share of the reward over the first 5,000"
        " iterations; they are made once without a price, to measure it (about a minute)",
    )


def _add_directories(line: argparse.ArgumentParser) -> None:
    group = line.add_argument_group("where, and what to go on from")
    group.add_argument("--out", type=Path, metavar="DIR", help="run directory (default: runs/...)")
    group.add_argument(
        "--resume",
        type=Path,
        metavar="DIR",
        help="go on with an interrupted run, with the settings that it has",
    )
    group.add_argument(
        "--extend",
        type=_whole,
        metavar="N",
        help="with --resume: N training iterations more; what falls towards the end of training,"
        " as the learning rate of the actor, then falls towards the new end",
    )
    group.add_argument(
        "--branch",
        metavar="RUN[@ITERATION]",
        help="begin a new run from a checkpoint of another, the newest or that after so many"
        " training iterations, with its settings but for those given here",
    )


def _add_ways_to_run(line: argparse.ArgumentParser) -> None:
    group = line.add_argument_group("how to run it")
    group.add_argument(
        "--in-process",
        action="store_true",
        help="the same run in one process on one core, without nodes: the same files, bit for bit",
    )
    group.add_argument(
        "--elsewhere",
        default=(),
        type=_nodes,
        metavar="NODE,...",
        help="nodes that you start yourself, on another machine: of "
        f"{', '.join(MOVABLE_NODES)}; see docs/reliability.md",
    )
    group.add_argument(
        "--live",
        nargs="?",
        const=Address(),
        type=Address.of,
        metavar="HOST:PORT",
        help="watch the run in Lichtblick or Foxglove; listens on this machine only unless HOST"
        f" says otherwise (default: {Address()})",
    )


def _whole(text: str) -> int:
    try:
        number = float(text.replace("_", ""))
        return int(text) if "e" not in text.lower() else _exact(number)
    except (ValueError, OverflowError) as error:
        raise argparse.ArgumentTypeError(f"expected a whole number, got {text!r}") from error


def _exact(number: float) -> int:
    if not number.is_integer():
        raise ValueError(number)
    return int(number)


def _wholes(text: str) -> list[int]:
    return [_whole(part) for part in text.split(",")]


def _nodes(text: str) -> tuple[str, ...]:
    nodes = tuple(dict.fromkeys(text.split(",")))
    if unknown := [node for node in nodes if node not in MOVABLE_NODES]:
        raise argparse.ArgumentTypeError(
            f"expected some of {', '.join(MOVABLE_NODES)}, got {unknown[0]!r}"
        )
    return nodes
