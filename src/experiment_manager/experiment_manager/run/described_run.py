"""What a run is, according to its configuration."""

from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import Any

import yaml

from experiment_manager.measures.criteria import EvaluationSettings
from experiment_manager.run.config_file import parameters_in
from lockstep import InputError


class DescribedRun:
    """A run directory, and the configuration that the run was made with.

    about: the section of config.yaml that says what the run is.
    """

    def __init__(self, directory: Path, configuration: str, source: str) -> None:
        """configuration: text of config.yaml; source: of that text, for errors.

        Raises InputError when the text does not tell what the run is.
        """
        self.directory = Path(directory)
        self.name = self.directory.resolve().name
        self.configuration = configuration
        self.about = _about(configuration, source)

    @property
    def model(self) -> str:
        """M or M_C."""
        return str(self.about["model"])

    @property
    def profile(self) -> str:
        """Named settings that the run began with, "" for none."""
        return str(self.about.get("profile", ""))

    @property
    def seed(self) -> int:
        """Seed of the run."""
        return int(self.about["seed"])

    @property
    def n_iterations(self) -> int:
        """Training iterations that the whole run has."""
        return int(self.about["n_training_iterations"])

    @property
    def metabolic_cost_weight(self) -> float:
        """Lambda, 1/W."""
        return float(self.about["metabolic_cost_weight"])

    @property
    def commit(self) -> str:
        """Commit of the source."""
        return str(self.about["commit"])

    @property
    def versions(self) -> tuple[str, ...]:
        """Libraries that the run was made with."""
        return tuple(str(version) for version in self.about.get("versions", ()))

    def parameters(self, node: str) -> dict[str, Any]:
        """Return all parameters of a node from the run's configuration, by dotted name."""
        by_node = parameters_in(self.configuration)
        if node not in by_node:
            raise InputError(f"{self.directory}: the configuration has no node {node}")
        return by_node[node]

    @cached_property
    def evaluation_settings(self) -> EvaluationSettings:
        """How the run is tested."""
        return EvaluationSettings.of(parameters_in(self.configuration))


def _about(configuration: str, source: str) -> Mapping[str, Any]:
    """Return the section of config.yaml that says what the run is."""
    try:
        about = yaml.safe_load(configuration)["run"]["ros__parameters"]
    except (yaml.YAMLError, KeyError, TypeError) as error:
        raise InputError(f"{source}: expected a run's configuration: {error}") from error
    needed = {"model", "seed", "n_training_iterations", "metabolic_cost_weight", "commit"}
    missing = sorted(needed - set(about))
    if missing:
        raise InputError(f"{source}: its configuration lacks {', '.join(missing)}")
    return dict(about)
