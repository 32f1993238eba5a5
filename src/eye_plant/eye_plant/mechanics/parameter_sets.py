"""The parameter sets by name."""

from collections.abc import Mapping
from types import MappingProxyType

from eye_plant.mechanics.anatomical import ANATOMICAL
from eye_plant.mechanics.k17 import K17
from eye_plant.mechanics.parameters import ParameterSet

PARAMETER_SETS: Mapping[str, ParameterSet] = MappingProxyType(
    {"k17": K17, "anatomical": ANATOMICAL}
)
