"""docs/bags.md does what it says, and the Foxglove layout shows what it names."""

import json
import re
import shlex
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from experiment_manager.bag.reader import Bag
from experiment_manager.commands import inspect_bag
from lockstep.command_space import MUSCLE_NAMES
from lockstep.wire.topics import GROUND_TRUTH_NAMES, IMAGE, REWARD_NAMES, TOPIC_TYPES, VECTOR
from tests.pair import ACTOR_CRITIC_NAMES, COMMAND_NAMES

DOCS = Path(__file__).parents[3] / "docs"
NAMES = {
    "ground_truth": GROUND_TRUTH_NAMES,
    "reward": REWARD_NAMES,
    "actor_critic": ACTOR_CRITIC_NAMES,
    "muscle_command": COMMAND_NAMES,
    "muscle_activations": MUSCLE_NAMES,
}


def _blocks(language: str) -> list[str]:
    text = (DOCS / "bags.md").read_text()
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


@pytest.fixture
def here(small_run: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with runs/demo, in which the blocks are run."""
    shutil.copytree(small_run, tmp_path / "runs" / "demo")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_every_block_is_run() -> None:
    n_fences = len(re.findall(r"^```", (DOCS / "bags.md").read_text(), re.MULTILINE))
    assert n_fences == 2 * (len(_blocks("python")) + len(_blocks("bash")))


@pytest.mark.parametrize("i_block", range(len(_blocks("python"))))
def test_python_of_the_document(here, i_block, capsys) -> None:
    exec(compile(_blocks("python")[i_block], f"bags.md, block {i_block}", "exec"), {})
    assert capsys.readouterr().out.strip()


def test_the_first_block_prints_the_learning_curve(here, capsys) -> None:
    exec(_blocks("python")[0], {})
    lines = [line.split() for line in capsys.readouterr().out.splitlines()]
    tests = json.loads((here / "runs" / "demo" / "results.json").read_text())["tests"]
    expected = [[t["iteration"], t["median_abs_vergence_error_deg"]] for t in tests]
    assert np.allclose(np.array(lines, float), expected)


def test_command_lines_of_the_document(here: Path) -> None:
    (block,) = _blocks("bash")
    for line in block.splitlines():
        script, *arguments = shlex.split(line)
        assert script == "launch_scripts/inspect_bag.sh"
        assert inspect_bag.main(arguments) == 0
    assert list((here / "pictures" / "left" / "image_raw").glob("*.png"))


# --- the layout


@pytest.fixture(scope="module")
def layout() -> dict[str, Any]:
    document: dict[str, Any] = json.loads((DOCS / "foxglove_layout.json").read_text())
    return document


def _panels(tree: Any) -> Iterator[str]:
    if isinstance(tree, str):
        yield tree
    else:
        assert tree["direction"] in ("row", "column")
        yield from _panels(tree["first"])
        yield from _panels(tree["second"])


def _series(layout: dict[str, Any]) -> list[dict[str, Any]]:
    return [s for panel in layout["configById"].values() for s in panel.get("paths", ())]


def test_each_panel_is_shown_once(layout: dict[str, Any]) -> None:
    assert sorted(_panels(layout["layout"])) == sorted(layout["configById"])


def test_pictures_are_of_topics_with_pictures(layout: dict[str, Any]) -> None:
    panels = layout["configById"].values()
    topics = {panel["imageMode"]["imageTopic"] for panel in panels if "imageMode" in panel}
    assert topics == {"/left/image_raw", "/right/image_raw", "/features"}
    assert all(TOPIC_TYPES[topic.removeprefix("/")] == IMAGE for topic in topics)


def test_each_path_is_the_entry_that_its_label_names(layout: dict[str, Any]) -> None:
    shown = set()
    for series in _series(layout):
        match = re.fullmatch(r"/(\w+)\.(position|effort)\[(\d+)\]", series["value"])
        assert match is not None, series
        topic, index = match[1], int(match[3])
        assert TOPIC_TYPES[topic] == VECTOR
        assert NAMES[topic][index] == series["label"]
        assert series["enabled"] is True
        shown.add((topic, series["label"]))
    assert {
        ("ground_truth", "vergence_error_deg"),
        ("reward", "reward"),
        ("muscle_activations", "left_medial_rectus"),
        ("muscle_activations", "right_lateral_rectus"),
    } <= shown


def test_the_names_are_those_of_a_bag(small_run: Path) -> None:
    bag = Bag(small_run / "bag")
    for topic, names in NAMES.items():
        assert bag.vectors(topic)[topic].names == names
