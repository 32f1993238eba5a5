"""evaluate.sh --cover, --prisms and --acuity on small runs of all kinds of eyes."""

import json
import re

import cv2
import pytest

from active_binocular_vision.commands.evaluate import main
from lockstep import SIDES

KINDS = ("pair", "twelve", "gaze")
# What a plane and an eye or direction give.
_N_CONDITIONS = {"cover": 6, "prisms": 12}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", ["cover", "prisms", "acuity"])
def test_an_examination_prints_writes_and_draws(run_of, tmp_path, capsys, kind, name) -> None:
    figure, out = tmp_path / "figures" / "it.png", tmp_path / "it.json"
    line = [str(run_of(kind)), f"--{name}", "--stimuli-per-test", "1"]
    assert main([*line, "--figure", str(figure), "--out", str(out)]) == 0
    text = capsys.readouterr().out
    assert "1 pictures of its own test stimuli" in text
    assert "{" not in text
    document = json.loads(out.read_text())
    assert (document["examination"], document["n_stimuli"]) == (name, 1)
    assert document["seed"] == 1
    drawn = cv2.imread(str(figure))
    assert drawn is not None
    assert drawn.shape[1] == 1200
    if name in _N_CONDITIONS:
        assert len(document["conditions"]) == _N_CONDITIONS[name]


def test_the_document_is_printed_instead_of_the_table(run_of, capsys) -> None:
    line = [str(run_of("pair")), "--cover", "--stimuli-per-test", "2", "--json"]
    assert main(line) == 0
    first = capsys.readouterr().out
    document = json.loads(first)
    assert document["n_stimuli"] == 2
    conditions = [(c["covered"], c["object_distance_m"]) for c in document["conditions"]]
    assert conditions == [(side, m) for side in SIDES for m in (0.5, 2.0, 6.0)]
    # The same again: nothing is left to chance.
    assert main(line) == 0
    assert capsys.readouterr().out == first


def test_a_blurred_eye_has_a_lower_acuity_and_less_of_the_code(run_of, capsys) -> None:
    blur = ["--set", "eyes.camera.right_blur_px=100"]
    assert main([str(run_of("pair")), "--acuity", "--stimuli-per-test", "1", "--json", *blur]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["settings"] == {"camera.right_blur_px": 100}
    explained = {side: document["acuity"][side]["explained_share"] for side in SIDES}
    assert max(explained["right"]) < 0.02 < min(explained["left"])
    assert document["acuity"]["right"]["acuity_cycles_per_deg"] is None
    share = document["share_in_code"]
    assert share["left"] + share["right"] == pytest.approx(1.0)


def test_eyes_that_are_both_covered_have_no_shares_in_the_code(run_of, tmp_path, capsys) -> None:
    out = tmp_path / "it.json"
    line = [str(run_of("pair")), "--acuity", "--stimuli-per-test", "1", "--out", str(out)]
    for side in SIDES:
        line += ["--set", f"eye_plant.camera.{side}_occluded=true"]
    assert main(line) == 0
    assert json.loads(out.read_text())["share_in_code"] == dict.fromkeys(SIDES)
    assert re.search(r"left +[-0-9.]+ +[0-9.]+ +-\n", capsys.readouterr().out)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        (("--cover", "--prisms"), "not allowed with argument"),
        (
            ("--figure", "a.png"),
            "--figure: expected with one of --cover, --prisms, --acuity, --nine-positions, --main-",
        ),
        (("--cover", "--start-scale", "2"), "--start-scale: expected without an examination"),
        (("--cover-eye", "right"), "--cover-eye: expected with --nine-positions"),
        (("--cover", "--cover-eye", "right"), "--cover-eye: expected with --nine-positions"),
        (("--out", "a.json"), "--stimuli-per-test, --out and --json: expected with one of --check"),
        (("--json",), "--stimuli-per-test, --out and --json: expected with one of --check"),
    ],
)
def test_options_that_do_not_go_together(line, message, capsys) -> None:
    with pytest.raises(SystemExit) as exit_info:
        main(["run", *line])
    assert exit_info.value.code == 2
    assert message in capsys.readouterr().err


def test_eyes_that_cannot_look_at_a_plane_are_one_line(run_of, capsys) -> None:
    lost = ["--set", f"eyes.mechanics.strength={[0.0] * 12}"]
    assert main([str(run_of("pair")), "--cover", *lost]) == 2
    assert "error: no medial activation" in capsys.readouterr().err
