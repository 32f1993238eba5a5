"""The eyes against published values of real ones and of OpenEyeSim's, and the script."""

import json

import numpy as np
import pytest

from eye_plant.validation import __main__ as script
from eye_plant.validation import checks, figure
from eye_plant.validation.checks import CHECKS, MAPS_VARIABLE, Check
from eye_plant.validation.saccades import Saccade


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.name)
def test_the_eyes_are_as_published(check: Check) -> None:
    row = check.row()
    if row["ok"] is None:
        pytest.skip(f"{MAPS_VARIABLE} names no maps of OpenEyeSim")
    assert row["ok"], row


def _check(value: float) -> Check:
    return Check("tension", "a book", "gf", (8.0, 15.0), lambda: value)


@pytest.mark.parametrize(
    ("value", "ok"), [(8.0, True), (15.1, False), (7.9, False), (np.nan, None)]
)
def test_the_script_writes_its_rows_and_fails_with_a_bound(
    tmp_path, monkeypatch, value, ok
) -> None:
    monkeypatch.setattr(checks, "CHECKS", [_check(np.float64(value))])
    monkeypatch.setattr(figure, "draw", lambda path: path.write_text("a figure"))
    assert script.main(["--out", str(tmp_path / "new")]) == (ok is False)
    (row,) = json.loads((tmp_path / "new" / "plant_validation.json").read_text())
    assert row == {
        "name": "tension",
        "value": None if ok is None else value,
        "unit": "gf",
        "bound": "8 to 15",
        "ok": ok,
    }
    assert (tmp_path / "new" / "plant_validation.png").exists()


def test_maps_that_agree_are_measured_and_drawn(tmp_path, monkeypatch) -> None:
    # The power law for the cost, and ours for the adduction; the lateral activation varies slowest.
    from eye_plant.validation.checks import GRID, adduction_deg, power_law_w

    ours = np.stack([adduction_deg(GRID, GRID), power_law_w(GRID, GRID)], axis=-1)
    rows = [(m, n, *ours[i, j]) for j, n in enumerate(GRID) for i, m in enumerate(GRID)]
    np.savetxt(tmp_path / "maps.csv", rows, delimiter=",", header="medial,lateral,adduction,cost")
    monkeypatch.setenv(MAPS_VARIABLE, str(tmp_path / "maps.csv"))
    monkeypatch.setattr(checks, "CHECKS", CHECKS[:3])
    assert script.main(["--out", str(tmp_path)]) == 0
    found = [row["value"] for row in json.loads((tmp_path / "plant_validation.json").read_text())]
    assert found == pytest.approx([0.0, 0.0, 0.0], abs=0.02)
    assert (tmp_path / "plant_validation.png").stat().st_size > 50_000


def test_what_the_script_cannot_use_is_said_in_a_line(tmp_path, monkeypatch, capsys) -> None:
    (tmp_path / "file").write_text("a,b,c,d\n1,2,3,4\n")
    monkeypatch.delenv(MAPS_VARIABLE, raising=False)
    with pytest.raises(SystemExit):
        script.main(["--out", str(tmp_path / "file")])
    assert "--out: expected a directory to write to" in capsys.readouterr().err
    for name in ("none", "file"):
        monkeypatch.setenv(MAPS_VARIABLE, str(tmp_path / name))
        with pytest.raises(SystemExit):
            script.main(["--out", str(tmp_path)])
        assert f"{MAPS_VARIABLE}: expected a file of 121 rows" in capsys.readouterr().err


def test_a_saccade_is_measured_between_its_threshold_crossings() -> None:
    velocity = np.array([0.0, 20.0, 40.0, 300.0, 50.0, 10.0, 35.0, 0.0])
    saccade = Saccade(np.arange(8.0) * 1e-3, np.arange(8.0), velocity)
    assert saccade.duration_ms == pytest.approx(3.0)
    assert saccade.peak_velocity_deg_s == 300.0
    assert saccade.amplitude_deg == 5.0
