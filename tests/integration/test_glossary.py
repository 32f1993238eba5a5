"""The glossary: at most 60 words, each with one line and a name that the code has."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
_ROW = re.compile(r"^\| (?!\*\*)([^|]+) \| ([^|]+) \| `(\w+)` \|$", re.MULTILINE)
_MOST_WORDS = 60


def test_each_word_of_the_glossary_stands_in_the_code() -> None:
    page = (ROOT / "docs/reference/glossary.md").read_text()
    rows = _ROW.findall(page)
    n_lines = sum(line.startswith("| ") and "**" not in line for line in page.splitlines())
    assert len(rows) == n_lines - 1, "every row but the head is a word, its meaning and a name"
    assert len(rows) <= _MOST_WORDS
    words = {word for path in (ROOT / "src").rglob("*.py") for word in _words(path)}
    assert [name for _, _, name in rows if name not in words] == []


def _words(path: Path) -> list[str]:
    return re.findall(r"\w+", path.read_text())
