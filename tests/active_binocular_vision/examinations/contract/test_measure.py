"""Declared measures: quartiles, JSON and tables."""

import math
from dataclasses import dataclass

import numpy as np
import pytest

from active_binocular_vision.examinations.contract.measure import (
    SHARE,
    Quartiles,
    columns_of,
    key,
    measure,
    record,
    text_of,
)


@dataclass(frozen=True, kw_only=True)
class Row:
    error_deg: Quartiles = measure("deg", "error", 1, spread=True)
    speed_deg_s: float = measure("deg/s", "speed", 0)
    both: np.ndarray = measure("", "both", 2, columns=("a", "b"), labels=("A", "B"))
    share: float | None = measure(SHARE, "fused")
    course: list[int] = measure("", "course", is_shown=False)
    eye: str = key("eye")


ROW = Row(
    error_deg=Quartiles(1.0, 2.0, None),
    speed_deg_s=3.0,
    both=np.array([0.5, np.nan]),
    share=0.25,
    course=[1, 2],
    eye="left",
)


def test_quartiles_are_linear_between_values() -> None:
    assert Quartiles.of([4.0, 1.0, 3.0, 2.0]) == pytest.approx((1.75, 2.5, 3.25))


def test_a_quartile_beyond_what_was_tried_is_none() -> None:
    assert Quartiles.of_censored([3.0, math.inf, 5.0, math.inf, 4.0]) == (4.0, 5.0, None)
    assert Quartiles.of_censored([-math.inf] * 3).median is None


def test_prism_dioptres_are_cm_at_one_metre() -> None:
    found = Quartiles(-1.0, None, 45.0).prism_dioptres
    assert found == (pytest.approx(-1.7455, abs=1e-4), None, pytest.approx(100.0))


def test_a_record_is_json() -> None:
    assert record(ROW) == {
        "error_deg": {"lower_quartile": 1.0, "median": 2.0, "upper_quartile": None},
        "speed_deg_s": 3.0,
        "a": 0.5,
        "b": None,
        "share": 0.25,
        "course": [1, 2],
        "eye": "left",
    }


def test_a_table_has_what_tells_rows_apart_first() -> None:
    header, line = (text.split("  ") for text in text_of([ROW]).splitlines())
    assert [t.strip() for t in header if t.strip()] == [
        "eye",
        "error/deg",
        "speed/(deg/s)",
        "A",
        "B",
        "fused",
    ]
    assert [t.strip() for t in line if t.strip()] == [
        "left",
        "2.0 (1.0 to -)",
        "3",
        "0.50",
        "-",
        "25.0 %",
    ]


def test_columns_have_the_names_of_the_record() -> None:
    assert list(columns_of(Row)) == list(record(ROW))
    assert columns_of(Row)["b"][1] == "B"
