"""The sheet of conditions and the figure of treatments at several ages, of made-up runs."""

from typing import Any

import numpy as np
import pytest

from active_binocular_vision.figures.conditions.sheet import sheet_figure
from active_binocular_vision.figures.conditions.treatments import (
    TREATED,
    courses_of,
    treatments_figure,
)
from active_binocular_vision.runs.conditions import Condition, conditions_of
from active_binocular_vision.runs.examined_run import BEFORE, END, ExaminedRun
from experiment_manager.preparation.profile_paths import profile_files
from experiment_manager.preparation.profiles import read_profile
from tests.active_binocular_vision.made_examined import column, examined, summaries
from tests.readable import assert_readable

FUSED = column("cover.share_fused")
SIX = [
    FUSED,
    column("cover.horizontal_deviation_pd"),
    *map(column, ("acuity.left_acuity_cycles_per_deg", "acuity.right_acuity_cycles_per_deg")),
    *map(column, ("tuning.binocular_share_fine", "test.metabolic_rate_w")),
]


def glasses(at: int | None, end: float, *, seed: int = 1, **other: Any) -> ExaminedRun:
    """Return a run with glasses at an age, or without; end: its share fused."""
    before = {} if at is None else {BEFORE: summaries(cover__share_fused=0.1)}
    return examined(
        "anisometropia_4" if at is None else "glasses",
        changed_at=() if at is None else (at,),
        seed=seed,
        found=before | {END: summaries(cover__share_fused=end)},
        **other,
    )


def some_conditions() -> list[Condition]:
    """Return glasses at two ages and untreated eyes, for dictionaries that rest; two seeds."""
    late = [glasses(1800, end, seed=seed) for seed, end in ((1, 0.2), (2, 0.4))]
    early = [glasses(200, end, seed=seed) for seed, end in ((1, 0.7), (2, 0.9))]
    return conditions_of([*late, *early, glasses(None, 0.3)])


def test_marks_of_the_sheet_are_medians_and_lines_ranges() -> None:
    runs = [
        examined(seed=seed, found={END: summaries(cover__share_fused=share)})
        for seed, share in enumerate((0.2, 0.4, 0.9))
    ]
    (axes,) = sheet_figure(conditions_of(runs), [FUSED]).axes
    spread, mark = (line.get_xdata() for line in axes.lines)
    assert np.asarray(spread) == pytest.approx([20.0, 90.0])
    assert np.asarray(mark) == pytest.approx([40.0])


def test_a_treatment_at_several_ages_is_a_course() -> None:
    plastic = [glasses(at, 0.5, final_learning_rate=0.2) for at in (200, 1800)]
    resting, other = courses_of([*some_conditions(), *conditions_of(plastic)])
    assert (resting.treatment, resting.label) == ("glasses", "M, frozen dictionaries")
    assert resting.ages_percent == (10.0, 90.0)
    assert [of.runs[0].changed_at for of in resting.conditions] == [(200,), (1800,)]
    assert resting.untreated is not None
    assert resting.untreated.runs[0].condition == "anisometropia_4"
    assert (other.label, other.untreated) == ("M, plastic dictionaries", None)
    assert not courses_of(conditions_of([glasses(200, 0.5), glasses(None, 0.3)]))
    alike = [glasses(200, 0.5, weight=weight) for weight in (0.1, 0.3)]
    assert not courses_of(conditions_of([*alike, glasses(1800, 0.5)]))
    palsies = [examined("sixth_nerve_palsy", changed_at=(at,)) for at in (200, 1800)]
    assert not courses_of(conditions_of(palsies))


def test_marks_of_treatments_are_medians_over_seeds_at_their_age() -> None:
    axes = treatments_figure(courses_of(some_conditions()), [FUSED]).axes[0]
    lines = {str(line.get_marker()): line for line in axes.lines}
    assert np.asarray(lines["D"].get_xdata()) == pytest.approx([10.0, 90.0])
    assert np.asarray(lines["D"].get_ydata()) == pytest.approx([80.0, 30.0])
    assert np.asarray(lines["o"].get_ydata()) == pytest.approx([10.0])
    spreads = [line.get_ydata() for line in axes.lines if line.get_marker() == "None"]
    expected = np.array([[70.0, 90.0], [20.0, 40.0], [30.0, 30.0]])
    assert np.asarray(spreads) == pytest.approx(expected)


def test_a_treatment_treats_the_condition_that_its_profile_begins_with() -> None:
    tests = "test_iterations"
    for treatment, condition in TREATED.items():
        profiles = [read_profile(f"clinic/{name}").settings for name in (treatment, condition)]
        without = [
            {node: {k: v for k, v in values.items() if k != tests} for node, values in p.items()}
            for p in profiles
        ]
        assert without[0] == without[1]
    palsies = {"sixth_nerve_palsy", "superior_oblique_palsy"}
    clinic = {name.removeprefix("clinic/") for name in sorted(profile_files()) if "clinic/" in name}
    scheduled = {name for name in clinic if read_profile(f"clinic/{name}").schedule.changes}
    assert set(TREATED) == scheduled - palsies


def test_figures_of_all_conditions_and_treatments_can_be_read() -> None:
    names = [n.rpartition("/")[2] for n in sorted(profile_files()) if n.startswith("clinic/")]
    runs = [examined(name, model=model) for name in names for model in ("M", "M_C")]
    assert_readable(sheet_figure(conditions_of(runs), SIX))
    runs = [
        examined(treatment, changed_at=(at,), final_learning_rate=rate)
        for treatment in TREATED
        for at in (200, 600, 1200, 1800)
        for rate in (0.0, 0.2)
    ]
    assert_readable(treatments_figure(courses_of(conditions_of(runs)), SIX))
