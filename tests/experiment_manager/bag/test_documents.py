"""docs/how_to/bags.md does what it says."""

import json
import re
import shlex
import shutil
from pathlib import Path

import numpy as np
import pytest

from active_binocular_vision.commands import bag as bag_command

DOCS = Path(__file__).parents[3] / "docs" / "how_to"


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
        assert bag_command.main(arguments) == 0
    assert list((here / "pictures" / "left" / "image_raw").glob("*.png"))
