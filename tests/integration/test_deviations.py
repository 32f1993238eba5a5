"""The list of deviations from the paper, and the lines of code that make them."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
_PAGE = ROOT / "docs" / "model" / "deviations.md"


def _listed() -> set[str]:
    return set(re.findall(r"^\| (D\d+) \|", _PAGE.read_text(), re.MULTILINE))


def _cited() -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    for suffix in ("py", "yaml"):
        for path in (ROOT / "src").rglob(f"*.{suffix}"):
            if path.parent.name == "config":
                continue  # made from the settings, which cite already
            for name in re.findall(r"\bD\d+\b", path.read_text()):
                found.setdefault(name, []).append(str(path.relative_to(ROOT)))
    return found


def test_each_deviation_is_cited_where_it_is_made_and_each_citation_is_listed() -> None:
    listed, cited = _listed(), _cited()
    assert len(listed) > 10
    assert listed - set(cited) == set(), "cite these at the line of code that makes them"
    assert set(cited) - listed == set(), f"add these to {_PAGE}: {cited}"


def test_deviations_are_numbered_through() -> None:
    numbers = sorted(int(name[1:]) for name in _listed())
    assert numbers == [*range(1, len(numbers) + 1)]
