"""What the measures count, by hand, with the eyes and cameras of a run."""

import math
from typing import Any

import pytest

from experiment_manager import EvaluationSettings
from experiment_manager.sections import DEFAULTS, Configuration
from lockstep.errors import InputError

STILL = "{at: 100, set: {eyes.camera.left_blur_px: 1.0}}"
TURNED_IN = "{at: 200, set: {eyes.mechanics.rest_adduction_deg: [5.0, 5.0]}}"


def sections(**changed: dict[str, Any]) -> Configuration:
    """The default configuration, except what is given by section."""
    return {section: of | changed.get(section, {}) for section, of in DEFAULTS.items()}


def test_k17s_eyes() -> None:
    found = EvaluationSettings.of(sections()).criteria(0)
    # A pixel is atan(1 / 257.34). Relaxed, the eyes converge by 0.96 deg; half a pixel more or
    # less are 1.0726 and 0.8500 deg, with 56 mm between the eyes.
    assert found.px_deg == pytest.approx(0.22265, abs=1e-5)
    assert found.silent_activation == 0.005
    assert found.lateral_is_silent_up_to_m == pytest.approx(2.991, abs=1e-3)
    assert found.medial_is_silent_from_m == pytest.approx(3.775, abs=1e-3)


def test_anatomical_eyes() -> None:
    settings = EvaluationSettings.of(sections(eyes={"mechanics.parameter_set": "anatomical"}))
    found = settings.criteria(0)
    # Nothing is charged at least, but the heat falls no further than 1 W/kg:
    # 1.5 A^0.6 (128 * 0.8 + 25) = 1.
    assert found.silent_activation == pytest.approx((1.5 * 127.4) ** (-1 / 0.6))
    # Relaxed, these eyes do not converge: to look at anything is to converge more.
    assert found.lateral_is_silent_up_to_m == math.inf
    assert found.medial_is_silent_from_m == math.inf


def test_each_stage_of_a_schedule_has_its_own() -> None:
    settings = EvaluationSettings.of(sections(task={"schedule": f"[{STILL}, {TURNED_IN}]"}))
    before, turned = (settings.criteria(n) for n in (200, 201))
    unchanged = EvaluationSettings.of(sections())
    assert before == unchanged.criteria(0), "the test at the change is before it"
    # Relaxed eyes that are turned in look at something nearer than all that is tested.
    assert turned.lateral_is_silent_up_to_m < turned.medial_is_silent_from_m < 0.5


def test_the_configuration_of_a_run_says_how_it_is_tested() -> None:
    configuration = sections(
        eyes={"camera.focal_length_px": 514.68}, task={"iterations_per_trial": 40}
    )
    settings = EvaluationSettings.of(configuration)
    assert settings.iterations_per_trial == 40
    assert settings.criteria(0).px_deg == pytest.approx(0.11133, abs=1e-5)


@pytest.mark.parametrize(
    ("section", "name"), [("task", "iterations_per_trial"), ("eyes", "camera.focal_length_px")]
)
def test_what_a_configuration_lacks_is_no_default(section: str, name: str) -> None:
    lacking = sections()
    del lacking[section][name]
    with pytest.raises(InputError, match=f"configuration, it lacks {section}.{name}$"):
        EvaluationSettings.of(lacking)
