"""The figure of treatments at several ages, of runs that were made up."""

import matplotlib as mpl
import numpy as np
import pytest

from active_binocular_vision.pages.clinic.rows import Row, rows_of
from active_binocular_vision.pages.clinic.treatments import TREATED, courses_of, treatments_figure
from active_binocular_vision.runs.examined_run import BEFORE, END, ExaminedRun
from experiment_manager.preparation.profiles import profile_names, read_profile
from lockstep.figures import STYLE
from tests.active_binocular_vision.pages.clinic.test_rows import (
    common,
    examined,
    examined_age,
    rows,
)
from tests.readable import assert_readable


def glasses(at: int | None, end: float, *, seed: int = 1, rate: float = 0.0) -> ExaminedRun:
    """Return a run of 2,000 iterations with glasses at an age, or without; end: its share fused."""
    before = () if at is None else (examined_age(BEFORE, share_fused=0.1),)
    return examined(
        "anisometropia_4" if at is None else "glasses",
        changed_at=at,
        seed=seed,
        final_learning_rate=rate,
        ages=(*before, examined_age(END, share_fused=end)),
    )


def some_rows() -> list[Row]:
    """Return glasses at two ages and untreated eyes, for dictionaries that rest; two seeds."""
    late = [glasses(1800, end, seed=seed) for seed, end in ((1, 0.2), (2, 0.4))]
    early = [glasses(200, end, seed=seed) for seed, end in ((1, 0.7), (2, 0.9))]
    return rows(*late, *early, glasses(None, 0.3))


def test_a_treatment_at_several_ages_is_a_course() -> None:
    plastic = [glasses(at, 0.5, rate=0.2) for at in (200, 1800)]
    resting, other = courses_of([*some_rows(), *rows(*plastic)])
    assert (resting.treatment, resting.label) == ("glasses", "M, resting dictionaries")
    assert resting.ages_percent == (10.0, 90.0)
    assert [row.runs[0].changed_at for row in resting.rows] == [200, 1800]
    assert resting.untreated is not None
    assert resting.untreated.runs[0].condition == "anisometropia_4"
    assert (other.label, other.untreated) == ("M, plastic dictionaries", None)
    assert not courses_of(rows(glasses(200, 0.5), glasses(None, 0.3)))
    alike = rows_of(
        runs := [glasses(200, 0.5)] * 2,
        [common(run, w) for run, w in zip(runs, (0.1, 0.3), strict=True)],
    )
    assert len(alike) == 2
    assert not courses_of([*alike, *rows(glasses(1800, 0.5))])
    palsies = [examined("sixth_nerve_palsy", changed_at=at) for at in (200, 1800)]
    assert not courses_of(rows(*palsies))


def test_marks_are_medians_over_seeds_at_their_age() -> None:
    axes = treatments_figure(courses_of(some_rows())).axes[0]
    lines = {str(line.get_marker()): line for line in axes.lines}
    assert np.asarray(lines["D"].get_xdata()) == pytest.approx([10.0, 90.0])
    assert np.asarray(lines["D"].get_ydata()) == pytest.approx([80.0, 30.0])
    assert np.asarray(lines["o"].get_ydata()) == pytest.approx([10.0])
    spreads = [line.get_ydata() for line in axes.lines if line.get_marker() == "None"]
    assert np.asarray(spreads) == pytest.approx(
        np.array([[70.0, 90.0], [20.0, 40.0], [30.0, 30.0]])
    )


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
    clinic = {name.removeprefix("clinic/") for name in profile_names() if "clinic/" in name}
    scheduled = {name for name in clinic if read_profile(f"clinic/{name}").schedule.changes}
    assert set(TREATED) == scheduled - palsies


def test_the_figure_of_all_treatments_can_be_read() -> None:
    runs = [
        examined(treatment, changed_at=at, final_learning_rate=rate, model=model)
        for treatment in TREATED
        for at in (200, 600, 1200, 1800)
        for rate in (0.0, 0.2)
        for model in ("M", "M_C")
    ]
    with mpl.rc_context(STYLE):
        figure = treatments_figure(courses_of(rows(*runs)))
        assert_readable(figure)
    assert len(figure.axes) == 5 * 6
