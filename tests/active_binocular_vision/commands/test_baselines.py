import csv
from collections.abc import Callable
from pathlib import Path

import pytest

from active_binocular_vision.baselines import extra
from active_binocular_vision.baselines.methods import METHODS
from active_binocular_vision.command_lines import baselines as line
from active_binocular_vision.commands.baselines import main
from active_binocular_vision.runs.results_folder import COLUMNS


def _rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return [*csv.DictReader(file)]


def test_rows_of_methods_stand_beside_those_of_the_run(
    run_of: Callable[[str], Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "new" / "table.csv"
    words = [str(run_of("pair")), "--out", str(out), "--every", "5", "--steps", "30"]
    assert main([*words, "--methods", "registration,ridge"]) == 0
    first = _rows(out)
    assert tuple(first[0]) == COLUMNS
    assert [*dict.fromkeys(row["run"] for row in first)] == ["run", "registration", "ridge"]
    assert {row["profile"] for row in first} == {"precise"}
    assert {row["iteration"] for row in first if row["run"] == "ridge"} == {"30"}
    table = capsys.readouterr().out
    assert [text.split()[1] for text in table.splitlines()[1:]] == ["run", "registration", "ridge"]
    # The same again replaces; the same seed gives the same numbers.
    assert main([*words, "--methods", "ridge"]) == 0
    assert sorted(map(str, _rows(out))) == sorted(map(str, first))


def test_all_methods_have_names_that_the_command_line_knows() -> None:
    assert set(line.METHODS) == set(METHODS)


def test_a_package_that_is_missing_is_named(
    run_of: Callable[[str], Path],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def missing(name: str) -> None:
        raise ImportError(f"No module named {name!r}")

    monkeypatch.setattr(extra, "import_module", missing)
    words = [str(run_of("pair")), "--out", str(tmp_path / "table.csv"), "--methods", "sac"]
    assert main(words) == 2
    assert "expected the package stable_baselines3 for this method" in capsys.readouterr().err


def test_a_run_without_a_checkpoint_needs_dictionaries(
    run_directories: dict[str, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([str(run_directories["M"]), "--out", str(tmp_path / "table.csv")]) == 2
    assert "expected a checkpoint, or --dictionary" in capsys.readouterr().err


def test_another_table_stays_as_it_is(
    run_directories: dict[str, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    other = tmp_path / "other.csv"
    other.write_text("a,b\n1,2\n")
    words = [str(run_directories["M"]), "--out", str(other), "--methods", "none"]
    assert main(words) == 2
    assert "other.csv: expected a table with columns run, model" in capsys.readouterr().err
    assert other.read_text() == "a,b\n1,2\n"
    # Without methods the runs alone have rows.
    words[2] = str(tmp_path / "new.csv")
    assert main([str(run_directories["M_C"]), *words]) == 0
    assert {row["model"] for row in _rows(tmp_path / "new.csv")} == {"M", "M_C"}
