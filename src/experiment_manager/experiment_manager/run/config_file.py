"""config.yaml of a run: the parameters of all nodes, and what the run is."""

import datetime
from collections.abc import Collection, Mapping
from importlib import metadata
from pathlib import Path
from typing import Any

import yaml

from experiment_manager.experiment.agreements import (
    by_key,
    by_node,
    check_agreements,
    with_partners,
)
from experiment_manager.experiment.config import ExperimentManagerConfig
from experiment_manager.run.checkpoint import Manifest
from eye_plant.config import EyePlantConfig
from lockstep.configuration import build, flatten
from lockstep.errors import InputError
from sparse_coder.config import SparseCoderConfig
from vergence_rl.config import VergenceRlConfig

CONFIG_FILE = "config.yaml"
CONFIG_CLASSES: dict[str, type] = {
    "eye_plant": EyePlantConfig,
    "sparse_coder": SparseCoderConfig,
    "vergence_rl": VergenceRlConfig,
    "experiment_manager": ExperimentManagerConfig,
}
# The pseudo-node of config.yaml that says what the run is; no ROS node has this name.
RUN_SECTION = "run"
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
_PACKAGES = ("mujoco", "numpy", "opencv-python-headless", "ros-jazzy-rclpy", "mcap", "numba")

Configuration = dict[str, dict[str, Any]]


def configuration_text(configuration: Configuration) -> str:
    """Return config.yaml: a ROS parameter file of all nodes, and what the run is."""
    return text_of_continuation("", configuration, {})


def text_of_continuation(text: str, configuration: Configuration, more: Mapping[str, Any]) -> str:
    """Return config.yaml of a run that goes on with other parameters than before.

    text: config.yaml so far, "" for a new run; more: further words on what the run is.
    """
    before = (yaml.safe_load(text) or {}).get(RUN_SECTION, {}).get("ros__parameters", {})
    begun = {
        "date": datetime.datetime.now(tz=datetime.UTC).isoformat(timespec="seconds"),
        "versions": [f"{name} {metadata.version(name)}" for name in _PACKAGES],
    }
    run = {**begun, **before, **about(configuration), **more}
    sections = {f"/**/{node}": values for node, values in configuration.items()}
    document = {
        name: {"ros__parameters": values}
        for name, values in ({RUN_SECTION: run} | sections).items()
    }
    return yaml.safe_dump(document, sort_keys=False)


def about(configuration: Configuration) -> dict[str, Any]:
    """Return what the parameters say the run is, as in the section of that name."""
    manager = configuration["experiment_manager"]
    return {
        "model": manager["model"],
        "profile": manager["profile"],
        "seed": manager["seed"],
        "n_training_iterations": manager["protocol.n_training_iterations"],
        "metabolic_cost_weight": manager["metabolic_cost_weight"],
        "commit": manager["commit"],
    }


def read_configuration(path: Path) -> Configuration:
    """Return the parameters by node of a config.yaml; raise InputError when it is none.

    So it is where parameters that must agree do not, or the section that says what the run is says
    something else than they do. What the file lacks follows from the parameter that it must agree
    with, or is the default.
    """
    try:
        document = yaml.safe_load(path.read_text())
        given = {node: document[f"/**/{node}"]["ros__parameters"] for node in CONFIG_CLASSES}
        configuration = completed(given)
        check_agreements(configuration)
        header = document.get(RUN_SECTION, {}).get("ros__parameters", {})
        _check_header(header, about(configuration))
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    except (OSError, ValueError, yaml.YAMLError, KeyError, TypeError, AttributeError) as error:
        raise InputError(f"{path}: expected the configuration of a run: {error}") from error
    return configuration


def completed(given: Mapping[str, Mapping[str, Any]]) -> Configuration:
    """Return all parameters of all nodes from those that a config.yaml of any version has.

    Raises InputError for what no node has.
    """
    complete = by_node(with_partners(by_key(given)), CONFIG_CLASSES)
    return {
        node: flatten(build(config_class, complete[node]))
        for node, config_class in CONFIG_CLASSES.items()
    }


def parameters_in(text: str, source: str = CONFIG_FILE) -> Configuration:
    """Return the parameters by node of a config.yaml's text, as they are, of any nodes.

    source: of the text, for errors. Raises InputError for what is no parameter file.
    """
    sections = _sections(text, source)
    return {name.removeprefix("/**/"): of for name, of in sections.items() if name != RUN_SECTION}


def about_in(text: str, source: str = CONFIG_FILE) -> dict[str, Any]:
    """Return the section of a config.yaml's text that says what the run is.

    source: of the text, for errors. Raises InputError where it does not say that.
    """
    about = _sections(text, source).get(RUN_SECTION, {})
    needed = {"model", "seed", "n_training_iterations", "metabolic_cost_weight", "commit"}
    if missing := sorted(needed - about.keys()):
        raise InputError(f"{source}: expected a run's configuration, it lacks {', '.join(missing)}")
    return about


def _sections(text: str, source: str) -> Configuration:
    try:
        sections = yaml.safe_load(text) or {}
        return {name: dict(section["ros__parameters"]) for name, section in sections.items()}
    except (yaml.YAMLError, KeyError, TypeError, ValueError, AttributeError) as error:
        raise InputError(f"{source}: expected parameters by node: {error}") from error


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
            f"--ros-args --params-file {path}"
        )


def _differing(
    expected: Configuration, found: Configuration, free: Mapping[str, Collection[str]]
) -> list[str]:
    return [
        f"{node}.{name} was {value!r}, is {found.get(node, {}).get(name)!r}"
        for node, values in expected.items()
        for name, value in values.items()
        if name not in free.get(node, ()) and found.get(node, {}).get(name) != value
    ]


def _check_header(header: Mapping[str, Any], expected: Mapping[str, Any]) -> None:
    for name, value in expected.items():
        if name in header and header[name] != value:
            raise InputError(
                f"{RUN_SECTION}.{name}: expected {value!r}, as experiment_manager has it, "
                f"got {header[name]!r}"
            )
