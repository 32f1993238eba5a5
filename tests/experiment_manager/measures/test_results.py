"""results.json is written as a whole, and only with numbers that JSON has."""

import json
import re
from pathlib import Path
from typing import Any

import pytest
from msgspec import to_builtins
from msgspec.structs import asdict, replace

from experiment_manager.measures.results import (
    ActivePairs,
    AntagonistPair,
    CostShares,
    Measures,
    Results,
    read_results,
    write_document,
)
from lockstep.errors import InputError
from tests.experiment_manager.summaries import NO_TRIALS, summary

AFTER_2 = Measures(**dict.fromkeys(Measures.__struct_fields__, 0.25))
ACTIVE = ActivePairs(0.2, 0.3, 0.5)
SET = replace(
    NO_TRIALS,
    n_trials=1,
    bias_by_distance_deg={"0.5": -0.1, "6": None},
    after_2=AFTER_2,
    antagonists_active=ACTIVE,
    antagonists={"a": AntagonistPair(0.01, ACTIVE, -0.5, {"6": ACTIVE})},
)
RUN = Results(
    model="M_C",
    profile="paper",
    seed=4,
    iterations=200_000,
    commit="abc",
    metabolic_cost_weight=0.08,
    cost_shares=CostShares(0.2, None),
    tests=(summary(**asdict(SET), starts_up_to_2_deg=SET),),
)


def test_the_written_file_has_the_documented_keys_and_is_read_as_it_was(tmp_path: Path) -> None:
    write_document(tmp_path / "results.json", RUN)
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
    assert test["starts_up_to_2_deg"] == {
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
        "median_metabolic_rate_w": None,
        "after_2": asdict(AFTER_2),
        "antagonists_active": asdict(ACTIVE),
        "antagonists": {
            "a": {
                "median_co_contraction": 0.01,
                "active": asdict(ACTIVE),
                "reciprocity_slope": -0.5,
                "active_by_distance": {"6": asdict(ACTIVE)},
            }
        },
    }
    assert [path.name for path in tmp_path.iterdir()] == ["results.json"]


def test_what_is_no_results_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "results.json"
    with pytest.raises(InputError, match=r"expected .*results\.json: No such file"):
        read_results(path)
    path.write_text("{")
    with pytest.raises(InputError, match="expected the results of a run: Input data was truncated"):
        read_results(path)
    path.write_text('{"model": "M"}')
    with pytest.raises(InputError, match="missing required field `profile`"):
        read_results(path)


@pytest.mark.parametrize(
    "measure", ["median_delta_cost_w", "after_2", "bias_by_distance_deg", "starts_up_to_2_deg"]
)
def test_a_damaged_measure_is_refused(measure: str, tmp_path: Path) -> None:
    document = to_builtins(RUN)
    document["tests"][0][measure] = "much"
    write_document(tmp_path / "results.json", document)
    with pytest.raises(InputError, match=r"results\.json: expected the results of a run"):
        read_results(tmp_path / "results.json")


def test_older_files_are_read(tmp_path: Path) -> None:
    path = tmp_path / "results.json"
    write_document(path, RUN)
    path.write_text(path.read_text().replace("starts_up_to_2_deg", "authors_test_set"))
    assert read_results(path) == RUN


def test_every_key_of_a_result_is_in_the_document() -> None:
    folder = Path(__file__).parents[3] / "docs" / "reference"
    text = "".join((folder / name).read_text() for name in ("measures.md", "measures.csv"))
    keys = _keys(to_builtins(RUN))
    assert {"share_antagonist_silent", "first_5000"} < keys
    assert not keys - set(re.findall(r"`([a-z_A-Z0-9]+)`", text)) - {"0.5", "6", "a"}


def _keys(value: Any) -> set[str]:
    if isinstance(value, list | tuple):
        return set().union(*map(_keys, value))
    return set(value).union(*map(_keys, value.values())) if isinstance(value, dict) else set()
