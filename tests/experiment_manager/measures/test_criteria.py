"""What the measures count, by hand, with the eyes and cameras of a run."""

import math
from typing import Any

import pytest

from experiment_manager.measures.criteria import EvaluationSettings
from experiment_manager.run.config_file import CONFIG_CLASSES, Configuration
from lockstep.configuration import flatten
from lockstep.errors import InputError

SMALLER = "{at: 100, set: {eye_plant.camera.focal_length_px: 514.68}}"
TURNED_IN = "{at: 200, set: {eye_plant.mechanics.rest_adduction_deg: [5.0, 5.0]}}"


def parameters(**changed: dict[str, Any]) -> Configuration:
    """Default parameters of all nodes, except those given by node."""
    nodes = CONFIG_CLASSES.items()
    return {node: flatten(config()) | changed.get(node, {}) for node, config in nodes}


def test_k17s_eyes() -> None:
    found = EvaluationSettings.of(parameters()).criteria(0)
    # A pixel is atan(1 / 257.34). Relaxed, the eyes converge by 0.96 deg; half a pixel more or
    # less are 1.0726 and 0.8500 deg, with 56 mm between the eyes.
    assert found.px_deg == pytest.approx(0.22265, abs=1e-5)
    assert found.silent_activation == 0.005
    assert found.lateral_is_silent_up_to_m == pytest.approx(2.991, abs=1e-3)
    assert found.medial_is_silent_from_m == pytest.approx(3.775, abs=1e-3)


def test_anatomical_eyes() -> None:
    settings = EvaluationSettings.of(
        parameters(eye_plant={"mechanics.parameter_set": "anatomical"})
    )
    found = settings.criteria(0)
    # Nothing is charged at least, but the heat falls no further than 1 W/kg:
    # 1.5 A^0.6 (128 * 0.8 + 25) = 1.
    assert found.silent_activation == pytest.approx((1.5 * 127.4) ** (-1 / 0.6))
    # Relaxed, these eyes do not converge: to look at anything is to converge more.
    assert found.lateral_is_silent_up_to_m == math.inf
    assert found.medial_is_silent_from_m == math.inf


def test_each_stage_of_a_schedule_has_its_own() -> None:
    settings = EvaluationSettings.of(
        parameters(experiment_manager={"schedule": f"[{SMALLER}, {TURNED_IN}]"})
    )
    before, smaller, turned = (settings.criteria(n) for n in (100, 200, 201))
    assert before == EvaluationSettings.of(parameters()).criteria(0), (
        "the test at the change is before it"
    )
    assert smaller.px_deg == pytest.approx(0.11133, abs=1e-5)
    # Relaxed eyes that are turned in look at something nearer than all that is tested.
    assert turned.lateral_is_silent_up_to_m < turned.medial_is_silent_from_m < 0.5


@pytest.mark.parametrize(
    ("node", "name"),
    [
        ("experiment_manager", "protocol.iterations_per_trial"),
        ("eye_plant", "camera.focal_length_px"),
    ],
)
def test_what_a_configuration_lacks_is_no_default(node: str, name: str) -> None:
    lacking = parameters()
    del lacking[node][name]
    with pytest.raises(InputError, match=f"configuration, it lacks {node}.{name}$"):
        EvaluationSettings.of(lacking)


def test_another_plant_has_the_eyes_of_the_manager() -> None:
    anatomical = parameters(experiment_manager={"mechanics.parameter_set": "anatomical"})
    anatomical["eye_plant"] = {"gain": 1.0}
    found = EvaluationSettings.of(anatomical)
    assert found.plant.mechanics.parameter_set == "anatomical"
