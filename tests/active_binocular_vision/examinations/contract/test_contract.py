"""What holds for all examinations, with few places and small ladders."""

import json
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from active_binocular_vision import FrozenLearners
from active_binocular_vision.commands.examine import main
from active_binocular_vision.examinations.contract.declared import DECLARED
from active_binocular_vision.examinations.contract.measure import columns_of
from active_binocular_vision.examinations.registry import EXAMINATIONS
from active_binocular_vision.figures.examinations.registry import FIGURES
from active_binocular_vision.learners.shown import Shown
from lockstep import flatten
from lockstep.settings import declarations
from tests.active_binocular_vision.moved_eyes import moved_eyes
from tests.active_binocular_vision.perfect_eyes import perfect_eyes

FEW: dict[str, dict[str, Any]] = {
    "cover": {"distances_m": (2.0,)},
    "prisms": {"distances_m": (2.0,), "ladder_share": 0.03},
    "acuity": {"distances_m": (2.0,)},
    "stereo": {"distances_m": (2.0,)},
    "accommodation": {"objects_d": (0.5, 1.0)},
    "retinoscopy": {},
    "near-point": {"nearest_d": 3.0, "step_d": 1.0},
    "nine-positions": {"distances_m": (2.0,), "n_random": 4},
    "main-sequence": {"amplitudes_deg": (2.0, 10.0), "directions_deg": (0.0, 90.0)},
    "landscape": {"distances_m": (2.0,), "vergence_errors_deg": (-1.0, 0.0, 1.0)},
    "tuning": {},
}
OF_LENSES = {"accommodation", "retinoscopy", "near-point"}
# Errors of right postures, of the document's summary or tables.
CONDITIONS: dict[str, dict[str, object]] = {
    "healthy": {},
    "turned": {
        "camera.right_rotation_deg": 3.0,
        "camera.right_roll_deg": 1.0,
        "camera.left_elevation_deg": 1.0,
    },
    "magnified": {"camera.right_magnification": 1.1},
    "covered": {"camera.right_occluded": True},
}
every_examination = pytest.mark.parametrize("name", EXAMINATIONS)


def _words(name: str) -> list[str]:
    pairs = {n: list(v) if isinstance(v, tuple) else v for n, v in FEW[name].items()}
    return [word for n, value in pairs.items() for word in ("--option", f"{n}={value}")]


@every_examination
def test_an_examination_prints_writes_and_draws(run_of, tmp_path, capsys, name) -> None:
    run = run_of("triad" if name in OF_LENSES else "gaze")
    examination = EXAMINATIONS[name]
    out, figure = tmp_path / "it.json", tmp_path / "figures" / "it.png"
    line = [str(run), f"--{name}", *_words(name), "--json", str(out)]
    line += ["--test-stimuli", "1"]
    line += ["--figure", str(figure)] if name in FIGURES else []
    with moved_eyes(lambda _, target_deg: 1e-4 * (1.0 + np.nan_to_num(target_deg[0]))):
        assert main(line) == 0
    text = capsys.readouterr().out
    assert "{" not in text
    document = json.loads(out.read_text())
    assert (document["examination"], document["version"]) == (name, examination.version)
    assert (document["seed"], document["iteration"]) == (1, 40)
    assert document["options"] == flatten(examination.options(**FEW[name]))
    assert list(document["summary"]) == list(columns_of(examination.summary))
    tables = [rows for rows in document.values() if isinstance(rows, list)]
    assert tables
    for rows in tables:
        assert all(set(row) == set(rows[0]) for row in rows)
    for addition in FIGURES.get(name, ()):
        assert cv2.imread(str(figure.with_stem(f"it{addition}"))) is not None


@pytest.mark.parametrize("condition", CONDITIONS)
@pytest.mark.parametrize("name", sorted(set(EXAMINATIONS) - {"tuning", "landscape"} - OF_LENSES))
def test_eyes_in_the_right_posture_have_no_errors(gazing_run, name, condition) -> None:
    learners = FrozenLearners(gazing_run, settings=CONDITIONS[condition])
    with perfect_eyes() as seen_deg:
        found = EXAMINATIONS[name](learners, Shown(n_most=1), **FEW[name])
    assert np.abs(seen_deg).max(initial=0.0) < 1e-3
    measures = found.measures()
    for table, names in _ERRORS.get(name, {}).items():
        for row in measures[table]:
            values = [row[error] for error in names]
            errors = [v["median"] if isinstance(v, dict) else v for v in values]
            assert errors == pytest.approx([0.0] * len(names), abs=2e-3)
    if name == "nine-positions":
        gazes = found.traces.nine
        for posture_deg in (gazes.eyes.gaze_deg[:, :, 0], gazes.optimum.gaze_deg):
            np.testing.assert_allclose(posture_deg, gazes.wanted_gaze_deg, atol=2e-3)
    if name == "prisms":
        assert [row["gain"]["median"] for row in measures["conditions"]] == pytest.approx(
            [1.0] * 6, abs=5e-3
        )
        assert [row["n_broken"] for row in measures["conditions"]] == [0] * 6


GLASSES = {"lenses.refraction_d": (2.0, -1.0), "lenses.contact_lenses_d": (2.0, -1.0)}


@pytest.mark.parametrize("name", sorted(OF_LENSES | {"cover"}))
def test_eyes_with_lenses_in_the_right_posture_and_focus_have_no_errors(run_of, name) -> None:
    learners = FrozenLearners(run_of("triad"), settings=GLASSES)
    with perfect_eyes() as seen_deg:
        found = EXAMINATIONS[name](learners, Shown(n_most=1), **FEW[name])
    # A prism before one eye lets the pair look aside, where the plane needs less vergence.
    assert np.abs(seen_deg).max() < 3e-3
    measures = found.measures()
    if name == "accommodation":
        # They focus what a lens asks for, and no prism or lens makes them lose the other.
        assert [*measures["summary"].values()] == pytest.approx([1.0, 1.0, 0.0, 0.0, 0.0], abs=2e-3)
    elif name == "retinoscopy":
        assert [*measures["summary"].values()] == pytest.approx([0.0, 0.0], abs=1e-9)
    elif name == "near-point":
        assert [row["n_failed"] for row in measures["tests"]] == [0] * 4
    else:
        assert [row["phoria_horizontal_deg"]["median"] for row in measures["conditions"]] == (
            pytest.approx([0.0, 0.0], abs=2e-3)
        )


_ERRORS = {
    "cover": {
        "conditions": [
            *(f"{what}_{axis}_deg" for what in ("tropia", "phoria") for axis in ("horizontal",)),
            "phoria_vertical_deg",
            "phoria_cyclo_deg",
            "iterations_until_fused",
        ]
    },
    "nine-positions": {
        "looks": [
            "missed_deg",
            "horizontal_error_deg",
            "vertical_error_deg",
            "cyclovergence_error_deg",
        ]
    },
    "main-sequence": {"saccades": ["missed_deg"]},
}


@pytest.mark.parametrize("kind", ["pair", "twelve"])
@pytest.mark.parametrize("name", ["cover", "prisms", "acuity", "stereo"])
def test_eyes_without_saccades_are_examined_twice_alike(run_of, name, kind) -> None:
    def measures() -> Any:
        found = EXAMINATIONS[name](FrozenLearners(run_of(kind)), Shown(n_most=1), **FEW[name])
        return found.measures()

    assert measures() == measures()


def test_the_command_line_has_each_examination_with_its_options(capsys) -> None:
    with pytest.raises(SystemExit):
        main(["--help"])
    text = "".join(capsys.readouterr().out.split())
    assert list(EXAMINATIONS) == list(DECLARED)
    for name, examination in DECLARED.items():
        assert f"--{name} {examination.text}".replace(" ", "") in text
        for declared in declarations(examination.options):
            said = f"{declared.name}: {declared.setting.description}"
            assert said.replace(" ", "") in text


@pytest.mark.parametrize(
    ("line", "message"),
    [
        (("--cover", "--prisms"), "not allowed with argument"),
        (("--figure", "a.png"), "--figure: expected with one of --cover, --prisms, --acuity, "),
        (("--option", "covered=right"), "--option: expected with one of --cover, --prisms, "),
        (("--cover", "--start-scale", "2"), "--start-scale: expected without an examination"),
        (("--cover", "--start-errors", "code"), "--start-errors: expected without an examination"),
    ],
)
def test_options_that_do_not_go_together(line, message, capsys) -> None:
    with pytest.raises(SystemExit) as exit_info:
        main(["run", *line])
    assert exit_info.value.code == 2
    assert message in capsys.readouterr().err


@pytest.mark.parametrize(
    ("kind", "line", "message"),
    [
        ("gaze", "--nine-positions --option covered=both", "covered: expected "),
        ("gaze", "--cover --option coverd=left", "--option: unknown parameter coverd"),
        ("gaze", "--cover --figure chart.jpg", "expected a name that ends in .png, got chart.jpg"),
        ("gaze", "--tuning --figure chart.png", "--figure: expected one of --cover, "),
        ("gaze", "--nine-positions --random-dots", "--nine-positions: expected stimuli on a"),
        ("gaze", "--main-sequence --random-dots", "--main-sequence: expected stimuli on a plane"),
        ("gaze", "--landscape --random-dots", "--landscape: expected stimuli on a plane"),
        ("gaze", "--stereo --stimuli .", "--stereo: expected its own random-dot stereograms"),
        ("gaze", "--tuning --random-dots", "--tuning: expected no stimuli"),
        ("pair", "--nine-positions", "expected eyes that make saccades, as those of profile gaze"),
        *(
            ("pair", line, "expected eyes with lenses, as those of profile triad")
            for line in (
                *(f"--{name}" for name in sorted(OF_LENSES)),
                "--cover --option lenses_d=[0,1]",
                "--cover --option pinholes_mm=[1,1]",
            )
        ),
        ("pair", "--main-sequence", "expected eyes that make saccades, as those of profile gaze"),
        ("pair", f"--cover --set eyes.mechanics.strength={[0.0] * 12}".replace(", ", ","), "no "),
    ],
)
def test_what_cannot_be_examined_is_one_line(run_of, kind, line, message, capsys) -> None:
    run: Path = run_of(kind)
    capsys.readouterr()  # of the run, if this test is the first one to need it
    assert main([str(run), *line.split()]) == 2
    error = capsys.readouterr().err
    assert error.startswith("error: ")
    assert message in error
    assert error.count("\n") == 1
