"""What docs/how_to shows on a run does what it says."""

import re
import shlex
import shutil
from pathlib import Path

import pytest

from active_binocular_vision.commands import bag as bag_command

ROOT = Path(__file__).parents[3]
BAG_PAGE, *_ = PAGES = [
    ROOT / "docs" / "how_to" / f"{name}.md" for name in ("read_a_bag", "plot", "own_measure")
]


def _blocks(page: Path, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", page.read_text(), re.MULTILINE | re.DOTALL)


BLOCKS = [(page.stem, block) for page in PAGES for block in _blocks(page, "python")]


@pytest.fixture
def here(small_run: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with runs/demo and our results, in which the blocks are run."""
    shutil.copytree(small_run, tmp_path / "runs" / "demo")
    (tmp_path / "results").symlink_to(ROOT / "results")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(("page", "block"), BLOCKS)
def test_python_of_a_page(here: Path, page: str, block: str, capsys) -> None:
    exec(compile(block, page, "exec"), {})
    assert capsys.readouterr().out.strip() or "savefig" in block or "learners" in block


def test_command_lines_of_the_page(here: Path) -> None:
    (block,) = _blocks(BAG_PAGE, "bash")
    for line in block.splitlines():
        abv, name, *arguments = shlex.split(line)
        assert (abv, name) == ("abv", "bag")
        assert bag_command.main(arguments) == 0
    assert list((here / "images" / "left" / "image_raw").glob("*.png"))
