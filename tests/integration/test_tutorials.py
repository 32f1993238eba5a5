"""Each tutorial runs from its first cell to its last."""

import os
import re
from collections.abc import Iterator
from pathlib import Path

import matplotlib.pyplot as plt
import pytest

from experiment_manager.supervision.domains import own_domain

TUTORIALS = sorted((Path(__file__).parents[2] / "docs" / "tutorials").glob("*.md"))
_CELL = re.compile(r"^```\{code-cell\}\n(.*?)^```$", re.MULTILINE | re.DOTALL)


@pytest.fixture
def domain(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Give a tutorial a domain of its own, and the others their variables back."""
    variables = dict(os.environ)
    with own_domain() as number:
        os.environ["ROS_DOMAIN_ID"] = str(number)
        yield
    os.environ.clear()
    os.environ.update(variables)


@pytest.mark.parametrize("page", TUTORIALS, ids=lambda page: page.stem)
def test_a_tutorial_runs(
    page: Path, domain: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    cells = _CELL.findall(page.read_text())
    names: dict[str, object] = {"__name__": "__main__"}
    for i, cell in enumerate(cells):
        exec(compile(cell, f"{page.stem}, cell {i}", "exec"), names)
        plt.close("all")
    assert len(cells) > 1
