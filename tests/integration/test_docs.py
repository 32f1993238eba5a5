"""Links within the documentation lead somewhere."""

import re
import subprocess
from pathlib import Path

import pytest
import yaml

from active_binocular_vision.command_lines.docs import SCRIPT
from tests.patience import PATIENCE_S

ROOT = Path(__file__).parents[2]
DOCS = sorted((ROOT / "docs").rglob("*.md"))
RESULTS = sorted((ROOT / "results").glob("*.md"))
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *DOCS, *RESULTS]
_FENCED = re.compile(r"^```.*?^```$", re.MULTILINE | re.DOTALL)
_LINK = re.compile(r"\]\(([^)\s]+)\)")


def _anchors(page: Path) -> set[str]:
    headings = re.findall(r"^#+ (.+)$", page.read_text(), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", h.lower()).replace(" ", "-") for h in headings}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_to_files_and_headings_of_ours_lead_there(page: Path) -> None:
    for link in _LINK.findall(_FENCED.sub("", page.read_text())):
        file, _, anchor = link.partition("#")
        if re.match(r"\w+:", link):
            continue
        target = (page.parent / file).resolve() if file else page
        assert target.exists(), link
        assert not anchor or anchor in _anchors(target), link


def test_the_index_is_a_click_from_the_readme() -> None:
    assert "docs/index.md" in _LINK.findall((ROOT / "README.md").read_text())


def test_the_site_is_built_without_a_warning() -> None:
    """That is: each link leads somewhere, and each page is in the table of contents."""
    assert SCRIPT == ROOT / "launch_scripts" / "docs.sh"
    done = subprocess.run(
        [SCRIPT, "--check"], capture_output=True, text=True, check=False, timeout=PATIENCE_S
    )
    assert done.returncode == 0, done.stderr
    assert (ROOT / "build" / "site" / "docs" / "index.html").is_file()


def test_the_pages_are_short() -> None:
    assert len((ROOT / "README.md").read_bytes()) <= 7100
    assert sum(len(page.read_bytes()) for page in [ROOT / "README.md", *DOCS, *RESULTS]) <= 170_000


def test_the_citation_has_what_its_format_asks_for() -> None:
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    assert {"cff-version", "message", "title", "authors"} <= set(citation)
    assert citation["references"][0]["doi"] == "10.1101/160721"
