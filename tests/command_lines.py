"""Command lines of run_experiment.sh, and the configurations that they ask for."""

from collections.abc import Mapping

from active_binocular_vision.commands.command_line import arguments, request_of
from experiment_manager import configuration_of
from experiment_manager.run.config_file import Configuration


def set_words(settings: Mapping[str, object]) -> list[str]:
    """Return the words that set parameters, by NODE.PARAMETER."""
    return [word for key, value in settings.items() for word in ("--set", f"{key}={value}")]


def configured(*line: str) -> Configuration:
    """Return all parameters of all nodes of a new run."""
    return configuration_of(request_of(arguments(line)), "0123abc")
