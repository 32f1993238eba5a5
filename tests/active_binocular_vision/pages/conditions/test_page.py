"""report.sh --conditions on a small run whose eyes are corrected half-way."""

import json
import math
import shutil
import sys
from contextlib import redirect_stdout
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from active_binocular_vision.commands.report import main
from active_binocular_vision.commands.run import main as run_experiment
from active_binocular_vision.pages.conditions.page import (
    condition_rows,
    unreached,
)
from active_binocular_vision.runs.conditions import conditions_of
from active_binocular_vision.runs.examined_run import BIRTH, END
from active_binocular_vision.runs.run import EXAMINATIONS_FILE
from tests.active_binocular_vision.made_examined import column, examined, reared, summaries
from tests.command_lines import set_words
from tests.kept_tests import kept_tests
from tests.made_once import made_once

_HEALTHY = f"{{eyes.mechanics.recession_mm: {[0.0] * 12}}}"
_SETTINGS = {
    "task.schedule": f"[{{at: 40, set: {_HEALTHY}}}]",
    "experiment_manager.test_distances_m": "[2.0]",
    "experiment_manager.n_starts_per_distance": 1,
    "eye_plant.stimuli.size_px": 64,
    "task.n_bases": 20,
}
# What a tuning would fit takes long.
LINE = ["--conditions", "--columns", "test,cover"]


@pytest.fixture
def run(tmp_path_factory: pytest.TempPathFactory, pictures: Path, tmp_path: Path) -> Path:
    """Return the directory of a run of 80 iterations, one's own to change."""

    def make(directory: Path) -> None:
        line = ["--in-process", "--profile", "clinic/esotropia_10", "--iterations", "80"]
        line += ["--tests", "0,40", "--test-stimuli", "1", "--stimuli", str(pictures)]
        line += set_words(_SETTINGS)
        with redirect_stdout(sys.stderr):
            assert run_experiment([*line, "--out", str(directory / "run")]) == 0

    made = made_once(tmp_path_factory, "corrected_eyes", make) / "run"
    return Path(shutil.copytree(made, tmp_path / "run"))


def documents(run: Path) -> list[dict]:
    return json.loads((run / EXAMINATIONS_FILE).read_text())["examined"]


def test_a_run_is_examined_once_at_three_ages(run, tmp_path, capsys, monkeypatch) -> None:
    out = tmp_path / "out"
    assert main([str(run), str(tmp_path / "none"), *LINE, "--out", str(out)]) == 0
    printed = capsys.readouterr()
    assert printed.out == f"{out / 'conditions.html'}\n"
    none = tmp_path / "none"
    assert f"left out: expected a run directory or trained eyes, got {none}\n" in printed.err
    assert {path.stem for path in (out / "figures").iterdir()} == {
        "conditions",
        "conditions_2",
        "curves",
    }
    page = (out / "conditions.html").read_text()
    assert page.count("<td>esotropia 10°</td>") == 3
    found = documents(run)
    assert [(of["iteration"], of["examination"]) for of in found] == [
        (iteration, "cover") for iteration in (0, 40, 80)
    ]
    # Eyes that have not learned to move stay at rest: 10 deg inward, then straight ahead, while the
    # object needs atan(0.056 / 2) of convergence.
    needed_deg = math.degrees(math.atan(0.056 / 2.0))
    for document, turned_deg in zip(found, (10.0, 10.0, 0.0), strict=True):
        expected_pd = 100.0 * math.tan(math.radians(turned_deg - needed_deg))
        summary = document["summary"]
        assert summary["horizontal_deviation_pd"] == pytest.approx(expected_pd, abs=0.1)
        assert summary["share_fused"] == 0.0
    rate_w = np.median(kept_tests(run)[-1].metabolic_rate_w[:, -1])
    assert f"<td>{rate_w:.3f}</td>" in page

    # Again, from the file alone; documents of another version or other learners are made again.
    file = run / EXAMINATIONS_FILE
    changed = [of | {"states": "other"} if of["iteration"] == 40 else of for of in found]
    file.write_text(json.dumps({"examined": changed}))
    assert main([str(run), *LINE, "--out", str(out)]) == 0
    assert sorted(documents(run), key=lambda of: of["iteration"]) == found
    shutil.rmtree(run / "checkpoints")
    # So are those from before an option came, which has its default.
    earlier = [{**of, "options": {**of["options"]}} for of in found]
    for of in earlier:
        assert of["options"].pop("lenses_d") == [0.0, 0.0]
    file.write_text(json.dumps({"examined": earlier}))
    assert main([str(run), *LINE, "--out", str(out)]) == 0
    assert (out / "conditions.html").read_text() == page
    file.write_text(json.dumps({"examined": [of | {"version": 0} for of in found]}))
    capsys.readouterr()
    assert main([str(run), *LINE, "--out", str(out)]) == 2
    assert "expected a checkpoint after 80 training iterations, or cover" in capsys.readouterr().err


def test_what_cannot_be_examined_is_one_line(run: Path, tmp_path: Path, capsys) -> None:
    line = [str(run), *LINE, "--out", str(tmp_path / "out")]
    (run / EXAMINATIONS_FILE).write_text('{"examined": 1}')
    assert main(line) == 2
    assert "expected the examinations of a run" in capsys.readouterr().err
    (run / EXAMINATIONS_FILE).unlink()
    results = json.loads((run / "results.json").read_text())
    results["tests"].pop()
    (run / "results.json").write_text(json.dumps(results))
    assert main(line) == 2
    assert capsys.readouterr().err.endswith("expected a run with a test at its end, 80\n")
    assert not (tmp_path / "out").exists()
    assert not (run / EXAMINATIONS_FILE).exists()


def test_an_age_without_a_checkpoint_has_its_test_alone(run: Path, tmp_path: Path) -> None:
    shutil.rmtree(run / "checkpoints" / f"{0:09d}")
    # Where there are two cores, the second one is examined in another process.
    second = Path(shutil.copytree(run, tmp_path / "second"))
    assert main([str(run), str(second), *LINE, "--out", str(tmp_path)]) == 0
    assert [of["iteration"] for of in documents(run)] == [40, 80]
    assert documents(second) == documents(run)
    assert (tmp_path / "conditions.html").read_text().count("<td>birth</td>") == 1


def test_the_table_has_a_row_for_each_age() -> None:
    runs = [
        examined(
            seed=seed,
            found={
                BIRTH: summaries(acuity__left_acuity_cycles_per_deg=None),
                END: summaries(cover__horizontal_deviation_pd=deviation, stereo__threshold_deg=deg),
            },
        )
        for seed, deviation, deg in ((1, -1.0, 0.5), (2, 3.0, None))
    ]
    names = "cover.horizontal_deviation_pd", "cover.share_fused", "stereo.threshold_deg"
    columns = [*map(column, names), column("acuity.left_acuity_cycles_per_deg")]
    birth, end = condition_rows(conditions_of(runs), columns)
    assert [*birth][3:5] == ["horizontal deviation/PD", "fused / %"]
    assert [*birth.values()][:4] == ["healthy", "2", "birth", "0.5 (0.5 to 0.5)"]
    assert [*birth.values()][6] == "-"
    expected = ["healthy", "2", "end", "1.0 (-1.0 to 3.0)", "50 (50 to 50)", "0.500 (1 of 2)"]
    assert [*end.values()][:6] == expected


def test_columns_of_one_heading_are_told_apart() -> None:
    scales = [column(f"{name}.left_share_in_code") for name in ("landscape", "acuity")]
    (row, *_) = condition_rows(conditions_of([examined()]), scales)
    assert len(row) == 3 + len(scales)


def test_what_is_published_stands_beside_a_condition() -> None:
    rows = condition_rows(conditions_of([reared("normal"), reared("other")]), [])
    assert "0.12 +- 0.17 deg" in rows[0]["published"]
    assert "published" not in rows[1]


def test_vergence_errors_without_a_place_in_the_landscape_are_named() -> None:
    whole, broken = reared("normal"), reared("weak", valley=(np.nan, 0.1, np.nan))
    assert unreached(conditions_of([whole])) == []
    assert unreached(conditions_of([whole, replace(broken, seed=2)])) == ["weak at -1 and 1 deg"]
