"""Ages, rows, cells and figure of the page, of runs that were made up."""

import dataclasses
import re

import matplotlib as mpl
import numpy as np
import pytest

from active_binocular_vision.figures.treatments import clinic_figure
from active_binocular_vision.pages.clinic.page import clinic_table
from active_binocular_vision.pages.clinic.rows import Range, Row, rows_of
from active_binocular_vision.runs.examined_run import (
    AGES,
    BEFORE,
    BIRTH,
    END,
    EXAMINED_FILE,
    ExaminedAge,
    ExaminedRun,
    ages_of,
)
from active_binocular_vision.runs.groups import Common
from experiment_manager.preparation.profiles import profile_names
from lockstep import InputError
from lockstep.figures import STYLE
from tests.readable import assert_readable


def examined_age(when: str, **measures: float | None) -> ExaminedAge:
    """Return an age with some measures, 0.5 for all others."""
    names = [f.name for f in dataclasses.fields(ExaminedAge)][2:]
    values = dict.fromkeys(names, 0.5) | measures
    return ExaminedAge(when=when, iteration=1000 * AGES.index(when), **values)  # type: ignore[arg-type]


def examined(condition: str = "healthy", seed: int = 1, **other: object) -> ExaminedRun:
    """Return a run of 2,000 iterations with all ages, unless something else is asked for."""
    values: dict[str, object] = {
        "model": "M",
        "iterations": 2000,
        "changed_at": 1000,
        "final_learning_rate": 0.0,
        "ages": tuple(map(examined_age, AGES)),
    }
    return ExaminedRun(condition=condition, seed=seed, **values | other)  # type: ignore[arg-type]


def rows(*runs: ExaminedRun) -> list[Row]:
    """Return the rows of runs that have lambda and all other settings in common."""
    return rows_of(runs, [common(run) for run in runs])


def common(run: ExaminedRun, weight: float = 0.0, **settings: object) -> Common:
    """Return what a run has in common with its other seeds."""
    named = {
        "profile": run.condition,
        "changed_at": run.changed_at,
        "rate": run.final_learning_rate,
    }
    texts = {(f"experiment_manager.{name}", str(v)) for name, v in (named | settings).items()}
    return Common(run.model, weight, run.iterations, frozenset(texts))


@pytest.mark.parametrize(
    ("tested", "changed_at", "ages"),
    [
        ([0, 100], None, {BIRTH: 0, END: 100}),
        ([0, 40, 100], 40, {BIRTH: 0, BEFORE: 40, END: 100}),
        ([0, 20, 40, 60, 100], 50, {BIRTH: 0, BEFORE: 40, END: 100}),
        ([0, 40, 100], 30, {BIRTH: 0, END: 100}),
        ([40, 100], None, {END: 100}),
    ],
)
def test_the_ages_that_a_run_was_tested_at(tested, changed_at, ages) -> None:
    assert ages_of(tested, changed_at) == ages


def test_a_file_is_read_as_it_was_written(tmp_path) -> None:
    run = examined(ages=(examined_age(END, stereo_threshold_arcsec=None),))
    assert ExaminedRun.read(tmp_path) is None
    run.write(tmp_path)
    assert ExaminedRun.read(tmp_path) == run
    (tmp_path / EXAMINED_FILE).write_text('{"ages": [{}]}')
    with pytest.raises(InputError, match="expected the examinations of a run"):
        ExaminedRun.read(tmp_path)


def test_seeds_are_one_row_and_what_differs_is_in_its_name() -> None:
    runs = [
        examined("surgery", changed_at=changed_at, final_learning_rate=rate, seed=seed)
        for seed in (1, 2)
        for changed_at in (200, 1200)
        for rate in (0.0, 0.2)
    ]
    found = rows(*runs, examined("patching_half", model="M_C"))
    assert [(row.name.replace("\N{NO-BREAK SPACE}", " "), len(row.runs)) for row in found] == [
        ("surgery, at 10 %, resting, M", 2),
        ("surgery, at 10 %, plastic, M", 2),
        ("surgery, at 60 %, resting, M", 2),
        ("surgery, at 60 %, plastic, M", 2),
        ("glasses, patching half, M_C", 1),
    ]
    assert [row.name for row in rows(examined("esotropia_5"))] == ["esotropia 5°"]


def test_runs_with_other_settings_or_another_price_are_rows_of_their_own() -> None:
    runs = [examined(seed=seed) for seed in (1, 2, 1, 2)]
    keys = [common(run, memory_share=share) for run, share in zip(runs, "1122", strict=True)]
    found = rows_of(runs, keys)
    assert [row.name for row in found] == ["healthy, memory_share 1", "healthy, memory_share 2"]
    assert [row.runs for row in found] == [tuple(runs[:2]), tuple(runs[2:])]
    keys = [common(runs[0], weight) for weight in (0.1, 0.3)]
    names = [row.name for row in rows_of(runs[:2], keys)]
    assert names == ["healthy, λ = 0.1 / W", "healthy, λ = 0.3 / W"]


def test_a_measure_over_the_seeds_that_have_it() -> None:
    values = (0.2, None, 0.6, 0.3)
    ages = [examined_age(END, share_fused=1.0, stereo_threshold_arcsec=v) for v in values]
    (row,) = rows(*(examined(seed=seed, ages=(age,)) for seed, age in enumerate(ages)))
    assert row.over_seeds(END, "stereo_threshold_arcsec") == Range(0.3, 0.2, 0.6, 3)
    assert row.over_seeds(END, "share_fused") == Range(1.0, 1.0, 1.0, 4)
    assert row.over_seeds(BIRTH, "share_fused") is None


def test_the_table_has_a_line_for_each_age() -> None:
    first = examined_age(
        END, horizontal_deviation_pd=-1.0, share_fused=0.9, left_acuity_cycles_per_deg=None
    )
    second = examined_age(
        END, horizontal_deviation_pd=3.0, share_fused=0.8, stereo_threshold_arcsec=None
    )
    birth = examined_age(BIRTH, left_acuity_cycles_per_deg=None)
    runs = [examined(ages=(birth, first)), examined(seed=2, ages=(birth, second))]
    cells = re.findall(r"<td>(.*?)</td>", clinic_table(rows(*runs)))
    assert len(cells) == 2 * 14
    assert cells[:3] == ["healthy", "2", "birth"]
    assert cells[7] == "-"
    assert cells[14:20] == [
        "healthy",
        "2",
        "end",
        "1.0 (-1.0 to 3.0)",
        "0.5 (0.5 to 0.5)",
        "85 (80 to 90)",
    ]
    assert cells[21] == "0.50 (1 of 2)"


def test_marks_are_medians_and_lines_ranges() -> None:
    shares = (0.2, 0.4, 0.9)
    runs = [
        examined(seed=seed, ages=(examined_age(END, share_fused=share),))
        for seed, share in enumerate(shares)
    ]
    axes = clinic_figure(rows(*runs)).axes[2]
    spread, mark = (line.get_xdata() for line in axes.lines)
    assert np.asarray(spread) == pytest.approx([20.0, 90.0])
    assert np.asarray(mark) == pytest.approx([40.0])


def test_the_figure_of_all_conditions_can_be_read() -> None:
    names = [n.removeprefix("clinic/") for n in profile_names() if n.startswith("clinic/")]
    runs = [examined(name, model=model) for name in names for model in ("M", "M_C")]
    runs += [examined("patching_half", changed_at=200, final_learning_rate=r) for r in (0.0, 0.2)]
    with mpl.rc_context(STYLE):
        assert_readable(clinic_figure(rows(*runs)))
