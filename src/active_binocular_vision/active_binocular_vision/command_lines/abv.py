"""The command `abv`: one name for all that people start, and its help."""

import sys
from importlib import import_module
from importlib.metadata import version
from typing import NoReturn

from lockstep.exit_codes import EXIT_BAD_INPUT
from lockstep.machine.environment import adopt
from lockstep.written.command_line import command
from lockstep.written.nearest import unknown

_LINES = "active_binocular_vision.command_lines"
# By group, each command: the function that runs it, and one line of help.
_GROUPS = {
    "Experiments": {
        "run": (f"{_LINES}.run:main", "train and test; without options a demonstration"),
        "sweep": (f"{_LINES}.sweep:main", "many runs, on this machine or a Slurm cluster"),
        "evaluate": (f"{_LINES}.evaluate:main", "recompute the measures of a run from its bag"),
        "examine": (f"{_LINES}.examine:main", "test learners, as in an eye clinic"),
        "baselines": (f"{_LINES}.baselines:main", "test other methods as a run was tested"),
        "trained": (f"{_LINES}.trained:main", "list trained eyes, or make a file of a run's"),
        "report": (f"{_LINES}.report:main", "draw figures and tables of runs into one page"),
        "bag": (f"{_LINES}.bag:main", "show, export, film or repair a bag"),
        "docs": (f"{_LINES}.docs:main", "build the site of all pages, and open it"),
    },
    "The model": {
        "parameters": (f"{_LINES}.parameters:main", "list the parameters of the nodes"),
        "export-model": ("eye_plant.export.__main__:main", "write the eyes as MJCF"),
        "validate-plant": ("eye_plant.validation.__main__:main", "compare them with physiology"),
    },
    "Nodes, started one by one": {
        "plant": (f"{_LINES}.nodes:plant", "two eyes with twelve muscles, and their images"),
        "coder": (f"{_LINES}.nodes:coder", "learns basis functions; features and reward"),
        "agent": (f"{_LINES}.nodes:agent", "learns muscle commands"),
        "manager": (f"{_LINES}.nodes:manager", "drives and records a run"),
        "live-view": (f"{_LINES}.nodes:live_view", "shows a graph in Lichtblick or Foxglove"),
    },
}
COMMANDS = {name: what for group in _GROUPS.values() for name, what in group.items()}


def main() -> NoReturn:
    """Run the command line as this process."""
    name, *words = sys.argv[1:] or ["--help"]
    if name in ("-h", "--help"):
        print(_help())
        sys.exit()
    if name == "--version":
        print(version("active-binocular-vision"))
        sys.exit()
    if name not in COMMANDS:
        print(f"{command('').strip()}: error: command: {unknown(name, COMMANDS)}", file=sys.stderr)
        sys.exit(EXIT_BAD_INPUT)
    adopt()  # before NumPy is imported, which reads there how many threads it may start
    sys.argv = [command(name), *words]
    module, _, function = COMMANDS[name][0].partition(":")
    sys.exit(getattr(import_module(module), function)())


def _help() -> str:
    width = max(map(len, COMMANDS))
    groups = [
        f"{title}:\n" + "\n".join(f"  {name:{width}}  {text}" for name, (_, text) in group.items())
        for title, group in _GROUPS.items()
    ]
    return "\n\n".join(
        [
            f"usage: {command('COMMAND')} [options]",
            "Two simulated eyes learn to look at the same point.",
            *groups,
            f"{command('COMMAND')} --help shows the options of a command.",
        ]
    )


if __name__ == "__main__":
    main()
