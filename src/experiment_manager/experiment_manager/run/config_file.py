"""config.yaml of a run: the parameters of all nodes, and what the run is."""

import datetime
import shlex
from collections.abc import Collection, Mapping
from importlib import metadata
from pathlib import Path
from typing import Any

from experiment_manager.run.checkpoint import Manifest
from experiment_manager.sections import (
    DEFAULTS,
    SHARED_CLASSES,
    Configuration,
    completed,
)
from lockstep import InputError
from lockstep.written.yaml_text import dump_yaml, load_yaml

CONFIG_FILE = "config.yaml"
# The pseudo-node of config.yaml that says what the run is; no ROS node has this name.
RUN_SECTION = "run"
# Not "/**": ROS puts what -p says there, beside the file's value, and reads the one of its type.
EVERY_NODE, _PARAMETERS = "/**/*", "ros__parameters"
# What may differ between a run and its resumption without touching a number of it.
FREE_TO_CHANGE = {
    "experiment_manager": {
        "run_directory",
        "run_id",
        "resume",
        "supervised",
        "checkpoint_period_s",
        "keeps_tested_checkpoints",
        "gap_s",
        "commit",
    },
    "eye_plant": {"stimuli.cache_directory"},
}
# Parameters of older runs that are gone, with the values that meant what is done without them.
_GONE = {
    "scales.whitened": False,
    "rewards_information": False,
    "first_sensor_noise": [0.0],
    "lens.eyes_scales": 0,
}
_PACKAGES = ("mujoco", "numpy", "opencv-python-headless", "ros-jazzy-rclpy", "mcap", "numba")


def configuration_text(configuration: Configuration) -> str:
    """Return config.yaml: a ROS parameter file of all nodes, and what the run is."""
    return text_of_continuation("", configuration, {})


def text_of_continuation(text: str, configuration: Configuration, more: Mapping[str, Any]) -> str:
    """Return config.yaml of a run that goes on with other parameters than before.

    text: config.yaml so far, "" for a new run; more: further words on what the run is.
    """
    before = (load_yaml(text) or {}).get(RUN_SECTION, {}).get(_PARAMETERS, {})
    begun = {
        "date": datetime.datetime.now(tz=datetime.UTC).isoformat(timespec="seconds"),
        "versions": [f"{name} {metadata.version(name)}" for name in _PACKAGES],
    }
    run = {**begun, **before, **about(configuration), **more}
    shared = {
        name: value for section in SHARED_CLASSES for name, value in configuration[section].items()
    }
    nodes = {
        f"/**/{node}": values
        for node, values in configuration.items()
        if node not in SHARED_CLASSES
    }
    sections = {RUN_SECTION: run, EVERY_NODE: shared} | nodes
    document = {name: {_PARAMETERS: values} for name, values in sections.items()}
    return dump_yaml(document)


def about(configuration: Configuration) -> dict[str, Any]:
    """Return what the parameters say the run is, as in the section of that name."""
    manager, task = configuration["experiment_manager"], configuration["task"]
    return {
        "model": manager["model"],
        "profile": manager["profile"],
        "seed": task["seed"],
        "n_training_iterations": task["n_training_iterations"],
        "metabolic_cost_weight": task["metabolic_cost_weight"],
        "commit": manager["commit"],
    }


def read_configuration(path: Path) -> Configuration:
    """Return the configuration of a config.yaml; what the file lacks is the default.

    Raises InputError when the file is none, has what no node has, or says of the run something
    else than its parameters do.
    """
    try:
        text = path.read_text()
        configuration = completed(parameters_in(text))
        document = load_yaml(text) or {}
        if EVERY_NODE not in document:
            raise InputError(f"expected the configuration of a run, with a section {EVERY_NODE}")
        header = document.get(RUN_SECTION, {}).get(_PARAMETERS, {})
        _check_header(header, about(configuration))
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: expected the configuration of a run: {error}") from error
    return configuration


def parameters_in(text: str) -> Configuration:
    """Return the configuration by section in a config.yaml's text, as it is, of any nodes.

    Raises InputError for what is no parameter file.
    """
    found = without_gone(_parameter_file(text))
    found.pop(RUN_SECTION, None)
    shared = found.pop(EVERY_NODE, {})
    configuration: Configuration = {
        section: {name: shared.pop(name) for name in DEFAULTS[section] if name in shared}
        for section in SHARED_CLASSES
    }
    if shared:
        raise InputError(f"unknown parameter {', '.join(sorted(shared))}")
    return configuration | {name.rpartition("/")[2]: values for name, values in found.items()}


def without_gone(configuration: Mapping[str, Mapping[str, Any]]) -> Configuration:
    """Return the parameters of a run, by section, without those gone that changed nothing."""
    return {
        section: {k: v for k, v in values.items() if k not in _GONE or _GONE[k] != v}
        for section, values in configuration.items()
    }


def about_in(text: str) -> dict[str, Any]:
    """Return the section of a config.yaml's text that says what the run is.

    Raises InputError where it does not say that.
    """
    about = _parameter_file(text).get(RUN_SECTION, {})
    needed = {"model", "seed", "n_training_iterations", "metabolic_cost_weight", "commit"}
    if missing := sorted(needed - about.keys()):
        raise InputError(f"expected the configuration of a run, it lacks {', '.join(missing)}")
    return about


def _parameter_file(text: str) -> Configuration:
    try:
        return {name: dict(s[_PARAMETERS]) for name, s in (load_yaml(text) or {}).items()}
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise InputError(f"expected the configuration of a run: {error}") from error


def check_unchanged(directory: Path, manifest: Manifest, found: Configuration) -> None:
    """Raise InputError, naming them, where parameters are not those of a checkpoint.

    directory: of the run. A parameter that the checkpoint does not know may be anything.
    """
    differing = _differing(manifest.parameters, found, FREE_TO_CHANGE)
    if differing:
        raise InputError(
            f"{directory}: expected the parameters that the run has been made with: "
            f"{'; '.join(differing)}. Set them back, or begin a new run from its checkpoint with "
            "--branch"
        )


def check_as_written(path: Path, written: Configuration, found: Configuration) -> None:
    """Raise InputError, naming them, where nodes run with other parameters than a config.yaml has.

    Nodes that are not in both are not compared; a directory may have another path elsewhere.
    """
    free = {node: set(names) for node, names in FREE_TO_CHANGE.items()}
    free["eye_plant"] |= {"stimuli.directory"}
    both = {node: values for node, values in written.items() if node in found}
    if differing := _differing(both, found, free):
        raise InputError(
            f"{path}: expected nodes with its parameters: {'; '.join(differing)}. Start them with "
            f"--ros-args --params-file {shlex.quote(str(path))}"
        )


def _differing(
    expected: Configuration, found: Configuration, free: Mapping[str, Collection[str]]
) -> list[str]:
    return [
        f"{node}.{name} was {value!r}, is {found.get(node, {}).get(name)!r}"
        for node, values in without_gone(expected).items()
        for name, value in values.items()
        if name not in free.get(node, ()) and found.get(node, {}).get(name) != value
    ]


def _check_header(header: Mapping[str, Any], expected: Mapping[str, Any]) -> None:
    for name, value in expected.items():
        if name in header and header[name] != value:
            raise InputError(
                f"{RUN_SECTION}.{name}: expected {value!r}, as the parameters have it, "
                f"got {header[name]!r}"
            )
