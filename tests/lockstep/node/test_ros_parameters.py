"""What `describe_parameters` of a node answers: meaning, unit and bounds of each parameter."""

import math
import sys
from dataclasses import dataclass, field
from typing import Any

import pytest
from rcl_interfaces.msg import ParameterDescriptor, ParameterType
from rcl_interfaces.srv import DescribeParameters
from rclpy.node import Node

from experiment_manager import ExperimentManagerConfig
from eye_plant import EyePlantConfig
from lockstep import check_settings, flatten, setting
from lockstep.node.ros_parameters import declare_config
from sparse_coder import SparseCoderConfig
from tests.node_harness import Graph
from vergence_rl import VergenceRlConfig


@dataclass(frozen=True)
class Inner:
    share: float = setting(0.5, "share of light", least=0, below=1)


@dataclass(frozen=True)
class Config:
    distance_m: float = setting(1.0, "distance of the plane", "m", above=0)
    width_px: int = setting(8, "width", "px", least=2, most=64, multiple_of=2)
    seed: int = setting(1, "seed")
    limits: tuple[float, ...] = setting((0.0, 1.0), "limits", least=0, is_interval=True)
    model: str = setting("M", "model", choices=("M", "M_C"))
    inner: Inner = field(default_factory=Inner)

    def __post_init__(self) -> None:
        check_settings(self)


class Described(Node):
    def __init__(self, config_class: type, **kwargs: Any) -> None:
        super().__init__("described", **kwargs)
        self.config: Any = declare_config(self, config_class)


def _described(graph: Graph, config_class: type) -> dict[str, ParameterDescriptor]:
    node: Any = graph.add(lambda **kwargs: Described(config_class, **kwargs))
    client = node.create_client(DescribeParameters, "/described/describe_parameters")
    graph.spin_until(client.service_is_ready, "the parameter service")
    names = list(flatten(config_class()))
    future = client.call_async(DescribeParameters.Request(names=names))
    graph.spin_until(future.done, "the descriptions")
    return {described.name: described for described in future.result().descriptors}


def test_a_description_has_text_unit_type_and_bounds(graph: Graph) -> None:
    described = _described(graph, Config)
    distance = described["distance_m"]
    assert distance.description == "distance of the plane [m]"
    assert distance.additional_constraints == "more than 0 m"
    assert distance.type == ParameterType.PARAMETER_DOUBLE
    assert distance.read_only
    (bounds,) = distance.floating_point_range
    assert (bounds.from_value, bounds.to_value) == (math.nextafter(0, 1), sys.float_info.max)
    (bounds,) = described["width_px"].integer_range
    assert (bounds.from_value, bounds.to_value, bounds.step) == (2, 64, 2)
    (bounds,) = described["seed"].integer_range
    assert (bounds.from_value, bounds.to_value) == (-(2**63), 2**63 - 1)
    (bounds,) = described["inner.share"].floating_point_range
    assert (bounds.from_value, bounds.to_value) == (0.0, math.nextafter(1.0, 0.0))
    assert described["limits"].additional_constraints == "[lowest, highest], each 0 or more"
    assert described["model"].additional_constraints == "M or M_C"


@pytest.mark.parametrize(
    "config_class", [EyePlantConfig, SparseCoderConfig, VergenceRlConfig, ExperimentManagerConfig]
)
def test_each_parameter_of_each_node_is_described(graph: Graph, config_class: type) -> None:
    described = _described(graph, config_class)
    assert set(described) == set(flatten(config_class()))
    for name, descriptor in described.items():
        assert descriptor.description, name
        assert not descriptor.description.endswith("."), name
        units = {"_m": "m", "_s": "s", "_deg": "deg", "_px": "px", "_mm": "mm", "_hz": "Hz"}
        unit = next((u for suffix, u in units.items() if name.endswith(suffix)), "")
        assert not unit or descriptor.description.endswith(f"[{unit}]"), name
