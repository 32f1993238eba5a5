"""The command line of `abv baselines`."""

import argparse
from pathlib import Path

from active_binocular_vision.command_lines.start import start
from lockstep.written.command_line import CommandLine, command
from lockstep.written.nearest import unknown
from lockstep.written.paths import written_path

# Those of active_binocular_vision.baselines.methods, in the order in which they are made.
METHODS = ("registration", "energy_model", "ridge", "cma_es", "ppo", "sac")


def parser() -> argparse.ArgumentParser:
    """Return the command line of `abv baselines`."""
    line = CommandLine(
        prog=command("baselines"),
        description="Test other methods as a run was tested, with its eyes, stimuli and first "
        "gazes, and write their measures beside the run's own. sac, ppo and cma_es need the extra "
        "rl: pip install stable-baselines3 cma.",
    )
    line.add_argument(
        "runs",
        type=written_path,
        nargs="+",
        metavar="RUN",
        help="directory of a run, of a sweep or of results, a run of such a folder, or a name that"
        f" {command('trained')} lists; methods are tested as the first one, beside all of them",
    )
    line.add_argument(
        "--methods",
        type=_methods,
        default=METHODS,
        metavar="NAME,...",
        help=f"some of {', '.join(METHODS)}, or none (default: all)",
    )
    line.add_argument(
        "--dictionary",
        type=written_path,
        metavar="FILE",
        help="sparse_coder.npz with the dictionaries that methods see through (default: those of"
        " the first run's newest checkpoint)",
    )
    line.add_argument(
        "--every",
        type=_count,
        default=11,
        metavar="K",
        help="make one of K trials of the test (default: 11)",
    )
    line.add_argument(
        "--steps",
        type=_count,
        default=20_000,
        metavar="N",
        help="training of sac and ppo, and places to calibrate ridge (default: 20000)",
    )
    line.add_argument(
        "--out",
        type=written_path,
        default=Path("baselines.csv"),
        metavar="FILE.csv",
        help="table in which rows of the same methods, profile and seed are replaced (default:"
        " baselines.csv)",
    )
    return line


def _methods(text: str) -> tuple[str, ...]:
    names = tuple(name for name in text.split(",") if name != "none")
    for name in names:
        if name not in METHODS:
            raise argparse.ArgumentTypeError(unknown(name, METHODS))
    return names


def _count(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"expected a whole number of 1 or more, got {text!r}")
    return int(text)


def main() -> None:
    """Run the command line as this process."""
    start("baselines", parser)


if __name__ == "__main__":
    main()
