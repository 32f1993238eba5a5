"""Parameters of different nodes that mean the same thing: said once, they are the same everywhere.

A key is NODE.PARAMETER.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from eye_plant.camera.config import CameraTurns
from eye_plant.mechanics.model import MechanicsConfig
from lockstep.configuration import flatten
from lockstep.errors import InputError

Configuration = Mapping[str, Mapping[str, Any]]


@dataclass(frozen=True)
class Agreement:
    """The parameter at `second` is `factor` times that at `first`; a factor is of whole numbers."""

    first: str
    second: str
    factor: int = 1

    def second_from(self, value: Any) -> Any:
        """Return what the second must be when the first has this value."""
        return value if self.factor == 1 or type(value) is not int else value * self.factor

    def first_from(self, value: Any) -> Any:
        """Return what the first must be when the second has this value.

        Raises InputError for a value that no first one gives.
        """
        if self.factor == 1 or type(value) is not int:
            return value
        quotient, rest = divmod(value, self.factor)
        if rest:
            raise InputError(
                f"{self.second}: expected {self.factor} times {self.first}, got {value}"
            )
        return quotient


AGREEMENTS = (
    Agreement("sparse_coder.metabolic_cost_weight", "experiment_manager.metabolic_cost_weight"),
    *(
        Agreement(
            "experiment_manager.protocol.n_training_iterations", f"{node}.n_training_iterations"
        )
        for node in ("sparse_coder", "vergence_rl")
    ),
    Agreement(
        "experiment_manager.protocol.iterations_per_episode", "vergence_rl.iterations_per_episode"
    ),
    # A row of features for the coarse scale and one for the fine scale.
    Agreement("sparse_coder.n_bases", "vergence_rl.n_features", factor=2),
    *(
        Agreement(f"vergence_rl.{name}", f"experiment_manager.protocol.{name}")
        for name in ("command_space", "lowest_activations", "highest_activations")
    ),
    *(
        Agreement("vergence_rl.command_space", f"{node}.command_space")
        for node in ("eye_plant", "sparse_coder")
    ),
    *(
        Agreement(f"vergence_rl.gaze.{name}", other)
        for name in ("fixation_iterations", "measures_turns")
        for other in (f"sparse_coder.gaze.{name}", f"experiment_manager.protocol.{name}")
    ),
    Agreement("eye_plant.camera.focal_length_px", "sparse_coder.gaze.focal_length_px"),
    Agreement("vergence_rl.lowest_activations", "eye_plant.lowest_activations"),
    *(
        Agreement(f"eye_plant.mechanics.{name}", f"experiment_manager.mechanics.{name}")
        for name in flatten(MechanicsConfig())
    ),
    *(
        Agreement(f"eye_plant.camera.{name}", f"experiment_manager.camera.{name}")
        for name in flatten(CameraTurns())
    ),
)


def by_key(configuration: Configuration) -> dict[str, Any]:
    """Return {NODE.PARAMETER: value} of parameters by node."""
    return {
        f"{node}.{name}": value
        for node, values in configuration.items()
        for name, value in values.items()
    }


def by_node(values: Mapping[str, Any], nodes: Iterable[str]) -> dict[str, dict[str, Any]]:
    """Return the parameters of these nodes by node, from values by key."""
    configuration: dict[str, dict[str, Any]] = {node: {} for node in nodes}
    for key, value in values.items():
        node, _, name = key.partition(".")
        configuration[node][name] = value
    return configuration


def with_partners(given: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values by key, and those of the keys that must agree with them."""
    complete = dict(given)
    for agreement in AGREEMENTS:
        if agreement.second in given and agreement.first not in given:
            complete[agreement.first] = agreement.first_from(given[agreement.second])
    for agreement in AGREEMENTS:
        if agreement.first in complete:
            second = agreement.second_from(complete[agreement.first])
            complete.setdefault(agreement.second, second)
    return complete


def check_agreements(configuration: Configuration) -> None:
    """Raise InputError with both names and values unless all parameters agree that must.

    configuration: by node, then by parameter; nodes that are not in it are not asked.
    """
    values = by_key(configuration)
    for agreement in AGREEMENTS:
        if agreement.first not in values or agreement.second not in values:
            continue
        value, its_value = values[agreement.first], values[agreement.second]
        if agreement.second_from(value) != its_value:
            times = f"{agreement.factor} times " if agreement.factor > 1 else ""
            raise InputError(
                f"{agreement.second}: expected {times}{agreement.first}, which is {value}, "
                f"got {its_value}"
            )
