"""Parts of one self-contained HTML page: tables, and figures as data URIs."""

import base64
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

from matplotlib.figure import Figure

from active_binocular_vision.figures.style import FIGURES, save

_STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; max-width: 72em; margin: 2em auto; padding: 0 1em;
       color: #222; }
h1 { font-size: 1.5em; } h2 { font-size: 1.2em; margin-top: 2em; }
div { overflow-x: auto; }
table { border-collapse: collapse; margin: 1em 0; font-variant-numeric: tabular-nums; }
th, td { padding: 0.25em 0.5em; text-align: right; border-bottom: 1px solid #ddd; }
th:first-child, td:first-child { text-align: left; }
th { border-bottom: 2px solid #999; font-weight: 600; }
figure { margin: 1em 0; } img { max-width: 100%; }
figcaption { color: #555; font-size: 0.9em; max-width: 50em; }
pre { background: #f6f6f6; padding: 1em; overflow-x: auto; font-size: 0.85em; }
"""


def page(title: str, parts: Sequence[str]) -> str:
    """Return the whole page; parts are HTML."""
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f"<title>{escape(title)}</title>\n<style>{_STYLE}</style>\n</head>\n<body>\n"
        f"<h1>{escape(title)}</h1>\n" + "\n".join(parts) + "\n</body>\n</html>\n"
    )


def heading(text: str) -> str:
    """Return a section's heading."""
    return f"<h2>{escape(text)}</h2>"


def paragraph(text: str) -> str:
    """Return a paragraph of plain text."""
    return f"<p>{escape(text)}</p>"


def table(rows: Sequence[Mapping[str, str]]) -> str:
    """Return a table of plain texts by heading, a dash where a row has none; "" without rows.

    The headings are in the order of the row with most of them. A wide table scrolls by itself.
    """
    headings = dict.fromkeys(name for row in sorted(rows, key=len, reverse=True) for name in row)
    lines = [[escape(row.get(name, "-")) for name in headings] for row in rows]
    head = "".join(f"<th>{escape(name)}</th>" for name in headings)
    body = "\n".join("<tr><td>" + "</td><td>".join(line) + "</td></tr>" for line in lines)
    return f"<div><table>\n<tr>{head}</tr>\n{body}\n</table></div>" if rows else ""


def section(title: str, text: str, *tables: Sequence[Mapping[str, str]]) -> list[str]:
    """Return tables with a heading, "" for none, and a paragraph; nothing without a row."""
    if not any(tables):
        return []
    return [heading(title)] * bool(title) + [paragraph(text), *map(table, tables)]


def folded(summary: str, text: str) -> str:
    """Return text that is shown as it is when the reader unfolds it."""
    return f"<details><summary>{escape(summary)}</summary><pre>{escape(text)}</pre></details>"


@dataclass(frozen=True)
class Drawing:
    """A figure of a page.

    title: "" for none; draw: returns None where there is nothing to draw; lack: a sentence without
    its point, what is not shown for want of what, "" for a figure that may silently be missing;
    left_out: the names of what lacks that.
    """

    name: str
    title: str
    caption: str
    draw: Callable[[], Figure | None]
    lack: str = ""
    left_out: Sequence[str] = ()

    def parts(self, out: Path) -> list[str]:
        """Draw it into out/figures; return it with its caption, or what it lacks."""
        figure = self.draw()
        title = [heading(self.title)] * bool(self.title)
        lack = f"{self.lack}{': ' * bool(self.left_out)}{', '.join(self.left_out)}."
        if figure is None:
            return [*title, paragraph(lack)] if self.lack else []
        data = save(figure, out / FIGURES / f"{self.name}.png").read_bytes()
        text = escape(f"{self.caption} {lack if self.left_out else ''}".strip())
        image = f"data:image/png;base64,{base64.b64encode(data).decode()}"
        return [
            *title,
            f'<figure><img src="{image}" alt="{text}"><figcaption>{text}</figcaption></figure>',
        ]
