"""Runs whose learners were examined, made up."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from active_binocular_vision.examinations.code.tuning import scale_row
from active_binocular_vision.examinations.contract.measure import record
from active_binocular_vision.learners.basis_functions import tunings
from active_binocular_vision.runs.conditions import Column, all_columns
from active_binocular_vision.runs.examined_run import AGES, ExaminedRun
from active_binocular_vision.runs.groups import Common
from lockstep.scales import SCALES
from tests.active_binocular_vision.learners.gabor_patch import gabor_patch

ERRORS_DEG = (-1.0, 0.0, 1.0)
VALLEY = (0.3, 0.1, 0.3)


def column(name: str) -> Column:
    """Return a column by its name, EXAMINATION.MEASURE."""
    return all_columns()[name]


def summaries(**measures: float | None) -> dict[str, Any]:
    """Return documents with 0.5 for each measure, except those given by EXAMINATION__MEASURE."""
    found: dict[str, Any] = {}
    for of in all_columns().values():
        summary = found.setdefault(of.examination, {"summary": {}})["summary"]
        summary[of.measure] = measures.get(f"{of.examination}__{of.measure}", 0.5)
    return found


def examined(
    condition: str = "healthy",
    seed: int = 1,
    *,
    found: Mapping[str, Any] | None = None,
    weight: float = 0.0,
    settings: Mapping[str, object] = {},
    **other: Any,
) -> ExaminedRun:
    """Return a run of 2,000 iterations with all ages, unless something else is asked for."""
    values: dict[str, Any] = {
        "model": "M",
        "iterations": 2000,
        "changed_at": (1000,),
        "final_learning_rate": 0.0,
        "px_deg": 0.2226,
        "curve": ((0, 2.0), (2000, 0.1)),
        "found": {age: summaries() for age in AGES} if found is None else found,
    } | other
    named = {
        "profile": condition,
        "at": values["changed_at"],
        "rate": values["final_learning_rate"],
    }
    texts = {(f"experiment_manager.{name}", str(v)) for name, v in (named | {**settings}).items()}
    common = Common(values["model"], weight, values["iterations"], frozenset(texts))
    return ExaminedRun(condition=condition, seed=seed, common=common, **values)


def reared(
    condition: str = "normal",
    error_deg: float = 0.1,
    *,
    right_eyes_share: float = 1.0,
    valley: tuple[float, ...] = VALLEY,
    **other: Any,
) -> ExaminedRun:
    """Return a run with a landscape, and basis functions of four orientations, at the end.

    right_eyes_share: how much weaker the right eye's half is.
    """
    lefts = [gabor_patch(wave_angle_deg=angle) for angle in (0.0, 45.0, 90.0, -45.0)]
    atoms = np.stack([np.concatenate([left, right_eyes_share * left]) for left in lefts])
    atoms /= np.linalg.norm(atoms, axis=1, keepdims=True)
    both = np.stack([atoms, atoms])
    rows = [
        record(scale_row(scale, tuned, of, 0.2226))
        for scale, tuned, of in zip(SCALES, tunings(both), both, strict=True)
    ]
    errors = [
        {"vergence_error_deg": at} | {f"reconstruction_error_{s}": error for s in SCALES}
        for at, error in zip(ERRORS_DEG, valley, strict=True)
    ]
    end = summaries(test__error_deg=error_deg)
    end["landscape"] |= {"errors": errors}
    end["tuning"] |= {"scales": rows}
    curve = ((0, 2.0), (2000, error_deg))
    values = {"changed_at": (), "curve": curve, "found": {"end": end}} | other
    return examined(condition, **values)
