"""results.json is written as a whole, and only with numbers that JSON has."""

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from experiment_manager.measures import tables
from experiment_manager.measures.results import Measures, Results, read_results, write_document
from lockstep import InputError
from tests.experiment_manager.summaries import NO_TRIALS, summary

RESULTS = Path(__file__).parents[3] / "results"

AFTER_2 = Measures(**dict.fromkeys(Measures.__dataclass_fields__, 0.25))
SET = replace(
    NO_TRIALS, n_trials=1, bias_by_distance_deg={0.5: -0.1, 6.0: None}, after={2: AFTER_2}
)
RUN = Results(
    model="M_C",
    profile="paper",
    seed=4,
    iterations=200_000,
    commit="abc",
    metabolic_cost_weight=0.08,
    cost_share_first=0.2,
    cost_share_last=None,
    tests=(summary(**vars(SET), authors_test_set=SET),),
)


def test_the_written_file_has_the_documented_keys_and_is_read_as_it_was(tmp_path: Path) -> None:
    write_document(tmp_path / "results.json", RUN.to_json())
    assert read_results(tmp_path / "results.json") == RUN
    document = json.loads((tmp_path / "results.json").read_text())
    (test,) = document.pop("tests")
    assert document == {
        "model": "M_C",
        "profile": "paper",
        "seed": 4,
        "iterations": 200_000,
        "commit": "abc",
        "lambda": 0.08,
        "lambda_share": {"first_5000": 0.2, "last_5000": None},
    }
    assert test["authors_test_set"] == {
        "n_trials": 1,
        "median_abs_vergence_error_deg": None,
        "iqr_abs_vergence_error_deg": None,
        "median_delta_cost_w": None,
        "median_cost_reduction": None,
        "share_within_1_px": None,
        "share_beyond_1_deg": None,
        "share_antagonist_silent": None,
        "bias_by_distance_deg": {"0.5": -0.1, "6": None},
        "median_abs_version_deg": None,
        "median_left_deviation_deg": None,
        "median_right_deviation_deg": None,
        "after_2": vars(AFTER_2),
    }
    assert list(test)[:3] == ["iteration", "n_trials", "median_abs_vergence_error_deg"]
    assert list(test)[-2:] == ["without_zero_start_error", "authors_test_set"]
    assert [path.name for path in tmp_path.iterdir()] == ["results.json"]


def test_a_number_that_is_not_finite_leaves_the_older_file(tmp_path: Path) -> None:
    write_document(tmp_path / "results.json", RUN.to_json())
    before = (tmp_path / "results.json").read_bytes()
    with pytest.raises(ValueError, match="not JSON compliant"):
        write_document(
            tmp_path / "results.json", replace(RUN, cost_share_first=float("nan")).to_json()
        )
    assert (tmp_path / "results.json").read_bytes() == before


def test_what_is_no_results_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "results.json"
    with pytest.raises(InputError, match=r"expected .*results\.json: No such file"):
        read_results(path)
    path.write_text("{")
    with pytest.raises(InputError, match="expected JSON"):
        read_results(path)
    path.write_text('{"model": "M"}')
    with pytest.raises(InputError, match="expected results with 'profile', got none"):
        read_results(path)


@pytest.mark.parametrize(
    "measure", ["median_delta_cost_w", "after_2", "bias_by_distance_deg", "authors_test_set"]
)
def test_a_damaged_measure_is_refused(measure: str, tmp_path: Path) -> None:
    document = RUN.to_json()
    document["tests"][0][measure] = "much"
    write_document(tmp_path / "results.json", document)
    with pytest.raises(InputError, match=r"results\.json: expected the results of a run"):
        read_results(tmp_path / "results.json")


def test_every_key_of_a_result_is_in_the_document() -> None:
    text = (Path(__file__).parents[3] / "docs" / "measures.md").read_text()
    keys = _keys(RUN.to_json())
    assert {"share_antagonist_silent", "first_5000"} < keys
    assert not keys - set(re.findall(r"`([a-z_A-Z0-9]+)`", text)) - {"0.5", "6"}


def _keys(value: Any) -> set[str]:
    if isinstance(value, list):
        return set().union(*map(_keys, value))
    return set(value).union(*map(_keys, value.values())) if isinstance(value, dict) else set()


@pytest.mark.parametrize("path", sorted(RESULTS.rglob("results.json")), ids=lambda p: p.parent.name)
def test_results_that_are_kept_can_be_shown(path: Path) -> None:
    tests = read_results(path).tests
    assert len(tables.summaries_table(tests).splitlines()) == 1 + len(tests)
