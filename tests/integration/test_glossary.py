"""The glossary: at most 60 words, each with one line and a name that the code has."""

import csv
import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
_MOST_WORDS = 60


def test_each_word_of_the_glossary_stands_in_the_code() -> None:
    lines = (ROOT / "docs/reference/glossary.csv").read_text().splitlines()
    rows = [row for row in csv.reader(lines[1:]) if not row[0].startswith("**")]  # a heading
    assert all(word and meaning for word, meaning, _ in rows)
    assert 30 < len(rows) <= _MOST_WORDS
    words = {word for path in (ROOT / "src").rglob("*.py") for word in _words(path)}
    assert [name for _, _, name in rows if name.strip("`") not in words] == []


def _words(path: Path) -> list[str]:
    return re.findall(r"\w+", path.read_text())
