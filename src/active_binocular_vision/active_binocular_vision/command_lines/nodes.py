"""Nodes that people start one by one."""

import os
import sys
from typing import NoReturn

from lockstep.machine.domain import DOMAIN_OF_SINGLE_NODES
from lockstep.machine.start import imported
from lockstep.written.command_line import CommandLine, command


def plant() -> NoReturn:
    """Start the eyes."""
    _become("plant", "eye_plant", "Two eyes with twelve muscles in MuJoCo, and their images.")


def coder() -> NoReturn:
    """Start the sparse coder."""
    _become("coder", "sparse_coder", "Learns basis functions; publishes features and reward.")


def agent() -> NoReturn:
    """Start the learner of commands."""
    _become("agent", "vergence_rl", "Turns features and reward into muscle commands.")


def manager() -> NoReturn:
    """Start the manager."""
    _become(
        "manager", "experiment_manager", "Drives the other nodes through a run, and records it."
    )


def live_view() -> NoReturn:
    """Start the live view."""
    text = "Shows a graph in Lichtblick or Foxglove."
    _become("live-view", "experiment_manager.live", text)


def _become(name: str, package: str, text: str) -> NoReturn:
    """Become the node of a package, unless asked for help."""
    if sys.argv[1:2] in (["-h"], ["--help"]):
        known = (
            "" if "." in package else f" {command('parameters')} {package} lists its parameters."
        )
        CommandLine(
            prog=command(name),
            usage="%(prog)s [--ros-args -p NAME:=VALUE -r FROM:=TO --params-file FILE ...]",
            description=f"{text}{known}",
            epilog="ROS_DOMAIN_ID names the ROS domain (default: "
            f"{DOMAIN_OF_SINGLE_NODES}, for all nodes that are started one by one).",
        ).parse_args(["--help"])
    if not os.environ.get("ROS_DOMAIN_ID"):
        os.environ["ROS_DOMAIN_ID"] = str(DOMAIN_OF_SINGLE_NODES)
    sys.exit(imported(f"{package}.node").main())
