import json
import math

import numpy as np
import pytest

from eye_plant.mechanics.oculomotor import MechanicsConfig, Oculomotor
from eye_plant.validation import __main__ as validation
from eye_plant.validation.dynamic_checks import saccade_rows, saccades
from eye_plant.validation.openeyesim import N_GRID, Maps, load_maps, power_law_w
from eye_plant.validation.passive_energy import passive_energy_j
from eye_plant.validation.row import Row
from eye_plant.validation.saccades import Saccade, holding_pair
from eye_plant.validation.secondary_gaze import gaze_along, gaze_directions
from eye_plant.validation.static_checks import (
    anatomical_tension_rows,
    count_wrong_signs,
    shared_rows,
)


def test_a_row_is_judged_by_both_ends_of_its_bound():
    assert Row("a", 8.0, "gf", 8.0, 15.0).ok is True
    assert Row("a", 15.1, "gf", 8.0, 15.0).ok is False
    assert Row("a", 0.2, "deg", high=0.15).ok is False
    assert Row("a", math.nan, "deg", high=0.15).ok is None


def test_a_row_is_written_with_its_bound_in_words():
    written = Row("gaze", np.float64(0.1), "deg", high=0.15).as_dict()
    assert json.loads(json.dumps(written)) == {
        "name": "gaze",
        "value": 0.1,
        "unit": "deg",
        "bound": "at most 0.15",
        "ok": True,
    }
    assert Row("gaze", math.nan, "deg", 1.0, 2.0).as_dict()["value"] is None


@pytest.mark.parametrize(("value", "status"), [(0.1, 0), (math.nan, 0), (0.2, 1)])
def test_validation_writes_its_rows_and_fails_when_a_bound_does(
    tmp_path, monkeypatch, value, status
) -> None:
    monkeypatch.setattr(
        validation, "measure", lambda maps: iter([Row("a", value, "deg", high=0.15)])
    )
    monkeypatch.setattr(validation, "draw_page", lambda path, maps: None)
    assert validation.main(["--out", str(tmp_path / "new")]) == status
    (row,) = json.loads((tmp_path / "new" / "plant_validation.json").read_text())
    assert row["ok"] is (None if math.isnan(value) else value <= 0.15)


def test_the_spline_of_a_map_is_exact_for_cubic_polynomials():
    def cubic(medial, lateral):
        return 40.0 * medial[:, None] ** 3 - 7.0 * medial[:, None] * lateral**2 + lateral - 0.5

    grid = np.linspace(0.0, 1.0, N_GRID)
    maps = Maps(cubic(grid, grid), np.zeros((N_GRID, N_GRID)))
    medial, lateral = np.linspace(0.0, 1.0, 57), np.linspace(0.0, 0.3, 23)
    found_deg = maps.spline_adduction_deg(medial, lateral)
    np.testing.assert_allclose(found_deg, cubic(medial, lateral), atol=1e-10)


def test_a_power_law_point_by_hand():
    # 2.229 * 0.1^0.6 = 0.55990; 2.030 * 0.005^0.6 = 0.08450
    assert power_law_w(0.1, 0.0) == pytest.approx(0.64440, abs=1e-4)


def test_maps_are_optional_but_a_wrong_path_is_named(monkeypatch, tmp_path):
    monkeypatch.delenv("ABV_OPENEYESIM_MAPS", raising=False)
    assert load_maps() is None
    monkeypatch.setenv("ABV_OPENEYESIM_MAPS", str(tmp_path / "no.csv"))
    with pytest.raises(ValueError, match="expected the name of a file"):
        load_maps()
    for text in ("a,b,c,d\n1,2,3,4\n", "a,b,c,d\n1,2,3,four\n", "a\n1,2\n3\n"):
        (tmp_path / "wrong.csv").write_text(text)
        monkeypatch.setenv("ABV_OPENEYESIM_MAPS", str(tmp_path / "wrong.csv"))
        with pytest.raises(ValueError, match=r"wrong\.csv: expected 121 rows"):
            load_maps()


def test_rows_of_maps_may_have_any_order(monkeypatch, tmp_path):
    grid = np.linspace(0.0, 1.0, N_GRID)
    # The lateral activation varies slowest here.
    rows = np.array(
        [(medial, lateral, 10 * medial, lateral) for lateral in grid for medial in grid]
    )
    path = tmp_path / "maps.csv"
    monkeypatch.setenv("ABV_OPENEYESIM_MAPS", str(path))
    np.savetxt(path, rows, delimiter=",", header="four columns", fmt="%.1f")
    maps = load_maps()
    assert maps is not None
    np.testing.assert_allclose(maps.adduction_deg, np.repeat(10 * grid[:, None], N_GRID, axis=1))
    np.testing.assert_allclose(maps.cost_w, np.repeat(grid[None], N_GRID, axis=0))
    rows[3, 0] = 0.35
    np.savetxt(path, rows, delimiter=",", header="four columns", fmt="%.2f")
    with pytest.raises(ValueError, match="expected each pair of medial and lateral activations"):
        load_maps()


def test_validation_says_in_a_line_what_it_cannot_use(monkeypatch, tmp_path, capsys):
    monkeypatch.setenv("ABV_OPENEYESIM_MAPS", str(tmp_path / "no.csv"))
    with pytest.raises(SystemExit) as maps:
        validation.main(["--out", str(tmp_path / "out")])
    (tmp_path / "file").write_text("")
    with pytest.raises(SystemExit) as out:
        validation.main(["--out", str(tmp_path / "file")])
    assert maps.value.code == out.value.code == 2
    told = capsys.readouterr().err
    assert "ABV_OPENEYESIM_MAPS: expected the name of a file" in told
    assert f"--out: expected a directory to write to, got {tmp_path / 'file'}" in told


def test_a_saccade_is_measured_between_its_threshold_crossings():
    time_s = np.arange(8.0) * 1e-3
    velocity = np.array([0.0, 20.0, 40.0, 300.0, 50.0, 10.0, 35.0, 0.0])
    saccade = Saccade(time_s, np.arange(8.0), velocity)
    assert saccade.duration_ms == pytest.approx(3.0)
    assert saccade.peak_velocity_deg_s == 300.0
    assert saccade.amplitude_deg == 5.0


def test_saccades_lie_on_the_main_sequence():
    made = saccades()
    assert list(made) == [5.0, 10.0, 15.0, 20.0, 25.0, 30.0]
    for row in saccade_rows(made):
        assert row.ok, row


@pytest.mark.parametrize("adduction_deg", [-45.0, -10.0, 10.0, 45.0])
def test_holding_pairs_hold(adduction_deg):
    eyes = Oculomotor(MechanicsConfig(parameter_set="anatomical"))
    pair = holding_pair(eyes, adduction_deg)
    eyes.settle(eyes.activations_from(*pair))
    held_deg = np.degrees(eyes.state().eye_angles_rad[:, 0])
    np.testing.assert_allclose(held_deg, adduction_deg, atol=1e-6)
    antagonist = pair[1] if adduction_deg > 0.0 else pair[0]
    assert antagonist < eyes.tonic_activations[0]


def test_tensions_and_torsion_are_physiological():
    for row in anatomical_tension_rows():
        assert row.ok, row


def test_secondary_gaze_takes_the_antagonistic_pairs_reciprocally():
    eyes = Oculomotor(MechanicsConfig(parameter_set="anatomical"))
    directions = gaze_directions(eyes)
    angles = gaze_along(eyes, directions, np.array([0.0, 20.0]))
    np.testing.assert_allclose(angles[:2], [0.0, 20.0], atol=1e-5)
    change = eyes.state().activations[:6] - eyes.tonic_activations[:6]
    assert change[2] > 0.0 > change[3]  # superior up, inferior rectus down
    assert change[5] > 0.0 > change[4]  # inferior up, superior oblique down


@pytest.mark.parametrize("parameter_set", ["k17", "anatomical"])
def test_shared_rows_are_within_their_bounds(parameter_set):
    rows = list(shared_rows(parameter_set))
    assert len(rows) == 4
    for row in rows:
        assert row.ok, row


def test_a_reversed_muscle_would_be_counted(monkeypatch):
    from eye_plant.validation import static_checks

    reversed_actions = static_checks.ACTIONS | {"superior_oblique": (1, 1, -1)}
    monkeypatch.setattr(static_checks, "ACTIONS", reversed_actions)
    assert count_wrong_signs(MechanicsConfig(parameter_set="anatomical")) == 3.0


@pytest.mark.parametrize("parameter_set", ["k17", "anatomical"])
def test_a_passive_swing_exchanges_its_energy_and_keeps_it(parameter_set):
    energy_j = passive_energy_j(MechanicsConfig(parameter_set=parameter_set), 0.2)
    assert energy_j.shape == (101,)
    assert energy_j[0] > 0.0
    np.testing.assert_allclose(energy_j, energy_j[0], rtol=1e-4)
    if parameter_set == "anatomical":
        # 0.2 rad off on each of six axes, tissue alone: 6 (k1 x^2 / 2 + k3 x^4 / 4)
        expected_j = 6.0 * (2.225e-3 * 0.04 / 2.0 + 3.453e-3 * 0.0016 / 4.0)
        assert energy_j[0] == pytest.approx(expected_j, rel=0.05)
