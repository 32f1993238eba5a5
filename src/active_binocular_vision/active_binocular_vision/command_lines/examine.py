"""The command line of `abv examine`."""

import argparse

from active_binocular_vision.command_lines.start import start
from active_binocular_vision.examinations.contract.declared import DECLARED, Declared
from lockstep.settings import declarations
from lockstep.written.command_line import CommandLine, command
from lockstep.written.paths import written_path


def parser() -> argparse.ArgumentParser:
    """Return the command line of `abv examine`."""
    line = CommandLine(
        prog=command("examine"),
        description="Test the learners of a checkpoint, without learning: as in the tests of the"
        " run, or with an examination as in an eye clinic. This needs only config.yaml and"
        " checkpoints/ of the run.",
    )
    line.add_argument(
        "run",
        type=written_path,
        metavar="RUN",
        help=f"run directory, or a name that {command('trained')} lists",
    )
    _add_shown(line)
    _add_learners(line)
    _add_examinations(line)
    line.add_argument(
        "--json",
        type=written_path,
        metavar="FILE",
        help="write the measures to FILE, with - print them in place of the table",
    )
    return line


def _add_shown(line: argparse.ArgumentParser) -> None:
    group = line.add_argument_group("what the learners are tested on")
    group.add_argument(
        "--stimuli",
        type=written_path,
        metavar="DIR",
        help="images in DIR/test, or all in DIR (default: the test stimuli of the run)",
    )
    group.add_argument(
        "--stereograms",
        type=written_path,
        metavar="DIR",
        help="pairs of images, one for each eye: NAME_left and NAME_right",
    )
    group.add_argument("--random-dots", action="store_true", help="random-dot stereograms")
    group.add_argument(
        "--generated",
        action="store_true",
        help="the generated test stimuli, for a run that was trained on other images",
    )
    group.add_argument(
        "--test-stimuli",
        type=int,
        metavar="K",
        help="largest number of images (default: as in the tests of the run)",
    )
    group.add_argument(
        "--start-scale",
        type=float,
        metavar="FACTOR",
        help="multiply the start errors and versions of the tests by FACTOR; only with a command"
        " for each muscle",
    )
    group.add_argument(
        "--start-errors",
        choices=("text", "code"),
        help="vergence errors at the start of trials: whole degrees as in the paper's text, or"
        " those of the authors' code, from -2 to 2 deg; only with one command for both eyes",
    )


def _add_learners(line: argparse.ArgumentParser) -> None:
    group = line.add_argument_group("which learners, with which eyes")
    group.add_argument(
        "--dictionary",
        type=written_path,
        metavar="CHECKPOINT",
        help="take the dictionaries from this directory in checkpoints/ of any run",
    )
    group.add_argument(
        "--actor",
        type=written_path,
        metavar="CHECKPOINT",
        help="take the learner of the commands from this directory in checkpoints/",
    )
    group.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="eyes.NAME=VALUE",
        help="change a setting of the eyes for the test; may be repeated",
    )
    group.add_argument(
        "--checkpoint",
        type=int,
        metavar="PLACE",
        help="number of the directory in checkpoints/ whose learners are tested (default: the"
        " newest)",
    )


def _add_examinations(line: argparse.ArgumentParser) -> None:
    """Add the options; they leave `examination`, None or a name, `option` and `figure`."""
    group = line.add_argument_group("examinations of the learners, as in an eye clinic")
    choice = group.add_mutually_exclusive_group()
    for name, declared in DECLARED.items():
        choice.add_argument(
            f"--{name}",
            action="store_const",
            const=name,
            dest="examination",
            help=_help_of(declared),
        )
    group.add_argument(
        "--option",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="change an option of the examination; may be repeated",
    )
    group.add_argument(
        "--figure",
        type=written_path,
        metavar="FILE.png",
        help="also draw what the examination found",
    )


def _help_of(examination: Declared) -> str:
    options = "; ".join(
        f"{declared.name}: {declared.setting.description}"
        for declared in declarations(examination.options)
    )
    return f"{examination.text} (options: {options})" if options else examination.text


def main() -> None:
    """Run the command line as this process."""
    start("examine", parser)


if __name__ == "__main__":
    main()
