"""The configuration of a run by sections, in which each setting stands once.

`task` and `eyes` are what several nodes need; a section of each node's name has the rest. A node's
configuration is made of all three, so its parameters have the same names without the section.
"""

from collections.abc import Mapping
from typing import Any, TypeVar

from experiment_manager.config import ExperimentManagerConfig
from experiment_manager.nodes import NODES
from eye_plant import EyePlantConfig
from eye_plant.config import EyesConfig
from lockstep import InputError, build, flatten
from lockstep.task import TaskConfig
from sparse_coder import SparseCoderConfig
from vergence_rl import VergenceRlConfig

Config = TypeVar("Config")
Configuration = dict[str, dict[str, Any]]

TASK, EYES = "task", "eyes"
SHARED_CLASSES: dict[str, type] = {TASK: TaskConfig, EYES: EyesConfig}
_CLASSES = (EyePlantConfig, SparseCoderConfig, VergenceRlConfig, ExperimentManagerConfig)
CONFIG_CLASSES: dict[str, type] = dict(zip(NODES, _CLASSES, strict=True))
_NODES = {config_class: node for node, config_class in CONFIG_CLASSES.items()}


_SHARED = {section: flatten(kind()) for section, kind in SHARED_CLASSES.items()}
_OF_NODES = {node: flatten(kind()) for node, kind in CONFIG_CLASSES.items()}


def section_of(node: str, name: str) -> str:
    """Return the section in which a parameter of a node stands."""
    return next((section for section, values in _SHARED.items() if name in values), node)


# {section: {name: default}}, which nobody changes.
DEFAULTS: Configuration = _SHARED | {
    node: {name: value for name, value in values.items() if section_of(node, name) == node}
    for node, values in _OF_NODES.items()
}
SECTIONS = tuple(DEFAULTS)


def values_of_node(configuration: Mapping[str, Mapping[str, Any]], node: str) -> dict[str, Any]:
    """Return all parameters of a node, by their names in ROS, that a configuration has."""
    # A misspelt name of the task is for the node to refuse; the eyes concern some nodes alone.
    shared = {
        name: value
        for section in SHARED_CLASSES
        for name, value in configuration.get(section, {}).items()
        if name in _OF_NODES[node] or section == TASK
    }
    return shared | dict(configuration.get(node, {}))


def config_of(config_class: type[Config], configuration: Mapping[str, Mapping[str, Any]]) -> Config:
    """Return a node's settings; what the configuration lacks has its default.

    Raises InputError for an unknown name and a value that the node refuses.
    """
    return build(config_class, values_of_node(configuration, _NODES[config_class]))


def completed(given: Mapping[str, Mapping[str, Any]]) -> Configuration:
    """Return all settings of all sections, checked as the nodes check them.

    Raises InputError for an unknown section or name, and a value that a node refuses.
    """
    for section in given:
        if section not in DEFAULTS:
            raise InputError(f"expected sections of {', '.join(DEFAULTS)}, got {section!r}")
    complete: Configuration = {
        section: flatten(build(kind, given.get(section, {})))
        for section, kind in SHARED_CLASSES.items()
    }
    for node, kind in CONFIG_CLASSES.items():
        values = flatten(config_of(kind, given))
        complete[node] = {name: values[name] for name in DEFAULTS[node]}
    return complete


def by_key(configuration: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """Return {SECTION.NAME: value}."""
    return {
        f"{section}.{name}": value
        for section, values in configuration.items()
        for name, value in values.items()
    }


def by_section(values: Mapping[str, Any]) -> Configuration:
    """Return {section: {name: value}} of values by key, SECTION.NAME."""
    configuration: Configuration = {section: {} for section in SECTIONS}
    for key, value in values.items():
        section, _, name = key.partition(".")
        configuration.setdefault(section, {})[name] = value
    return configuration


def sections_of_nodes(found: Mapping[str, Mapping[str, Any]]) -> Configuration:
    """Return a configuration from the parameters with which nodes run, by node.

    The manager's task and eyes count. Raises InputError for a node that has others.
    """
    manager = found["experiment_manager"]
    configuration: Configuration = {
        section: {name: manager[name] for name in DEFAULTS[section]} for section in SHARED_CLASSES
    }
    for node, values in found.items():
        configuration[node] = {}
        for name, value in values.items():
            section = section_of(node, name)
            if section == node:
                configuration[node][name] = value
            elif configuration[section][name] != value:
                raise InputError(
                    f"{node}: expected {name} {configuration[section][name]!r}, as "
                    f"experiment_manager has it, got {value!r}"
                )
    return configuration
