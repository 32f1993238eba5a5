"""A folder of results stands for the runs that it was written from."""

import csv
import json
import pickle
from pathlib import Path

import numpy as np
import pytest

from active_binocular_vision import Run, groups_of
from active_binocular_vision.commands.report import main
from active_binocular_vision.runs.results_folder import keep, runs_at, runs_with_tests
from experiment_manager.measures.tables import summaries_table
from lockstep.command_space import ALL_MUSCLES, PAIR
from lockstep.errors import InputError
from tests.active_binocular_vision.own_commands import write_run

RESULTS = Path(__file__).parents[3] / "results"
FOLDERS = sorted(path.parent for path in RESULTS.rglob("runs.yaml"))


@pytest.fixture
def made(tmp_path: Path) -> list[Run]:
    """Runs of a pair with and without a price, and of twelve muscles."""
    spaces = {
        "pair": (PAIR, "M", 0.0),
        "priced": (PAIR, "M_C", 0.1),
        "all": (ALL_MUSCLES, "M", 0.0),
    }
    return [Run(write_run(tmp_path / name, *of)) for name, of in spaces.items()]


def test_kept_runs_have_what_the_runs_had(made: list[Run], tmp_path: Path) -> None:
    found = {"examined": [{"examination": "cover", "summary": {"share_fused": 1 / 3}}]}
    (made[0].directory / "examinations.json").write_text(json.dumps(found))
    keep(made, tmp_path / "kept")
    kept = runs_at(tmp_path / "kept")
    assert [run.name for run in kept] == ["pair", "priced", "all"]
    assert [g.label for g in groups_of(kept)] == [g.label for g in groups_of(made)]
    for run, of_folder in zip(made, kept, strict=True):
        assert of_folder.about == run.about
        unread = of_folder.unread()
        assert (unread.document, unread.examinations) == (
            of_folder.document,
            of_folder.examinations,
        )
        assert len(pickle.dumps(unread)) < 0.5 * len(pickle.dumps(of_folder))
        assert of_folder.configuration == run.configuration
        assert summaries_table(of_folder.summaries) == summaries_table(run.summaries)
        last, others = run.summaries[-1], of_folder.summaries[-1]
        assert others.after[2].median_abs_vergence_error_deg == pytest.approx(
            last.after[2].median_abs_vergence_error_deg, rel=1e-5
        )
        if run.is_of_pair:
            assert others.starts_up_to_2_deg.n_trials == last.starts_up_to_2_deg.n_trials
        for at, trials in run.tests.items():
            errors_deg = of_folder.tests[at].vergence_error_deg
            np.testing.assert_allclose(errors_deg, trials.vergence_error_deg, rtol=1e-5)
    assert kept[0].examinations["examined"][0]["summary"] == {"share_fused": 0.333333}
    assert kept[1].examinations == {"examined": []}


def test_a_run_of_a_folder_is_named_as_if_it_were_a_directory(made, tmp_path) -> None:
    keep(made, tmp_path / "kept", with_trials=False)
    (run,) = runs_at(tmp_path / "kept" / "priced")
    assert (run.name, run.model, run.tests) == ("priced", "M_C", {})
    found, _ = runs_with_tests([tmp_path / "kept", tmp_path / "kept" / "all"])
    assert [run.name for run in found] == ["pair", "priced", "all"], "each once"


def test_runs_of_one_name_are_not_mixed(made: list[Run], tmp_path: Path) -> None:
    twin = tmp_path / "elsewhere" / made[0].name
    with pytest.raises(InputError, match=f"different names, got {made[0].directory} and {twin}"):
        keep([*made, Run(twin)], tmp_path / "kept")
    assert not (tmp_path / "kept").exists()


def test_a_sweep_has_its_runs_in_its_order(tmp_path: Path) -> None:
    (tmp_path / "sweep.yaml").write_text("axes: {seed: [2, 3, 1], profile: [paper]}")
    with pytest.raises(InputError, match="expected runs in the sweep"):
        runs_with_tests([tmp_path])
    for name in ("another", "seed_1-profile_paper", "seed_2-profile_paper"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "config.yaml").touch()
    names = [run.name for run in runs_at(tmp_path)]
    assert names == ["seed_2-profile_paper", "seed_1-profile_paper", "another"]


def test_measures_are_one_table(made: list[Run], tmp_path: Path) -> None:
    keep(made, tmp_path)
    with (tmp_path / "measures.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    (row,) = (
        row
        for row in rows
        if (row["run"], row["iteration"], row["trials"], row["after"], row["measure"])
        == ("priced", "1000", "all", "3", "median_abs_vergence_error_deg")
    )
    expected = made[1].summaries[-1].after[3].median_abs_vergence_error_deg
    assert expected is not None
    assert float(row["value"]) == pytest.approx(expected, rel=1e-5)
    assert (row["model"], row["seed"], row["commit"]) == ("M_C", "1", "0123abc")


def test_what_is_damaged_is_one_line(made, tmp_path, capsys) -> None:
    kept = tmp_path / "kept"
    assert main([*(str(run.directory) for run in made), "--keep", str(kept)]) == 0
    assert capsys.readouterr().out == f"{kept}\n"
    for name, content, told in (
        ("measures.csv", "run\npair\n", "expected its measures"),
        ("runs.yaml", "[", "expected the configurations of runs"),
    ):
        (kept / name).write_text(content)
        with pytest.raises(InputError, match=told):
            runs_at(kept)[0].summaries  # noqa: B018


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: str(folder.relative_to(RESULTS)))
def test_the_results_that_are_kept_can_be_read(folder: Path) -> None:
    for run in runs_at(folder):
        assert len(summaries_table(run.summaries).splitlines()) == 1 + len(run.summaries)
        assert run.evaluation_settings.criteria(run.n_iterations).px_deg > 0.0
        assert run.commit


def test_the_results_that_are_kept_are_few_and_small() -> None:
    files = [path for path in RESULTS.rglob("*") if path.is_file() and path.suffix != ".html"]
    assert len(files) <= 250
    assert sum(path.stat().st_size for path in files) <= 25e6
