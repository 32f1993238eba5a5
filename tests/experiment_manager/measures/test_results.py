"""results.json is written as a whole, and only with numbers that JSON has."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from experiment_manager.measures import tables
from experiment_manager.measures.criteria import TestSettings
from experiment_manager.measures.metrics import test_summary
from experiment_manager.measures.results import read_results, results_document, write_results
from experiment_manager.measures.trials import TRIAL_NAMES
from lockstep.errors import InputError
from lockstep.wire.topics import TEST

RESULTS = Path(__file__).parents[3] / "results"

VALUES: dict[str, Any] = {
    "model": "M_C",
    "profile": "paper",
    "seed": 4,
    "iterations": 200_000,
    "commit": "abc",
    "metabolic_cost_weight": 0.08,
    "cost_share_first": 0.2,
    "cost_share_last": None,
    "tests": [{"iteration": 0, "n_trials": 2, "median_abs_vergence_error_deg": 1.5}],
}


def test_the_written_file_has_the_documented_keys(tmp_path: Path) -> None:
    write_results(tmp_path / "results.json", **VALUES)
    assert json.loads((tmp_path / "results.json").read_text()) == {
        "model": "M_C",
        "profile": "paper",
        "seed": 4,
        "iterations": 200_000,
        "commit": "abc",
        "lambda": 0.08,
        "lambda_share": {"first_5000": 0.2, "last_5000": None},
        "tests": [{"iteration": 0, "n_trials": 2, "median_abs_vergence_error_deg": 1.5}],
    }
    assert [path.name for path in tmp_path.iterdir()] == ["results.json"]


def test_a_number_that_is_not_finite_leaves_the_older_file(tmp_path: Path) -> None:
    write_results(tmp_path / "results.json", **VALUES)
    before = (tmp_path / "results.json").read_bytes()
    with pytest.raises(ValueError, match="not JSON compliant"):
        write_results(tmp_path / "results.json", **(VALUES | {"cost_share_first": float("nan")}))
    assert (tmp_path / "results.json").read_bytes() == before


def test_what_is_no_results_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"expected .*none\.json: No such file"):
        read_results(tmp_path / "none.json")
    (tmp_path / "a.json").write_text("{")
    with pytest.raises(InputError, match="expected JSON"):
        read_results(tmp_path / "a.json")
    (tmp_path / "b.json").write_text('{"model": "M"}')
    with pytest.raises(InputError, match="expected commit, iterations, lambda"):
        read_results(tmp_path / "b.json")
    write_results(tmp_path / "c.json", **VALUES)
    assert read_results(tmp_path / "c.json")["seed"] == 4


def test_every_key_of_a_result_is_in_the_document() -> None:
    text = (Path(__file__).parents[3] / "docs" / "measures.md").read_text()
    rows = [[0.0] * len(TRIAL_NAMES) for _ in range(5)]
    for iteration, row in enumerate(rows):
        row[TRIAL_NAMES.index("phase")] = TEST
        row[TRIAL_NAMES.index("iteration")] = iteration
    document = results_document(
        **(VALUES | {"tests": [test_summary(np.array(rows), 4, TestSettings.of({}).criteria(0))]})
    )
    assert not _keys(document) - set(re.findall(r"`([a-z_A-Z0-9]+)`", text)) - {"0"}


def _keys(value: Any) -> set[str]:
    if isinstance(value, list):
        return set().union(*map(_keys, value))
    return set(value).union(*map(_keys, value.values())) if isinstance(value, dict) else set()


@pytest.mark.parametrize("path", sorted(RESULTS.rglob("results.json")), ids=lambda p: p.parent.name)
def test_results_that_are_kept_can_be_shown(path: Path) -> None:
    document = read_results(path)
    assert len(tables.tests_table(document["tests"]).splitlines()) == 1 + len(document["tests"])
