"""The known names that somebody who mistyped one may have meant."""

import difflib
import re
from collections.abc import Collection, Iterable

_MOST = 3
_LEAST_LIKENESS = 0.6
_LEAST_BEGINNING = 3  # letters, of a name that was begun
_LONGEST_LIST = 300


def nearest(name: str, known: Iterable[str]) -> list[str]:
    """Return up to three known names like this one, the most like it first; none if none is.

    A dotted name, or one with folders, is found by its last part too: width_px for camera.width_px.
    """
    names = sorted(known)
    likeness = {other: _likeness(name, other) for other in names}
    alike = [other for other in names if likeness[other] >= _LEAST_LIKENESS]
    return sorted(alike, key=lambda other: -likeness[other])[:_MOST]


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Return "; did you mean ...?" with the nearest names, or "" if none is near."""
    near = nearest(name, known)
    return f"; did you mean {' or '.join(near)}?" if near else ""


def unknown(name: str, known: Collection[str]) -> str:
    """Return what an error says of an unknown name: the nearest ones, all if none is near."""
    hint = did_you_mean(name, known)
    return (
        f"expected a known name, got {name!r}{hint}"
        if hint
        else f"expected one of {listed(known)}, got {name!r}"
    )


def listed(known: Collection[str]) -> str:
    """Return the names, of very many those in folders (or dotted ones) by their folders alone."""
    if len(text := ", ".join(known)) <= _LONGEST_LIST:
        return text
    return ", ".join(dict.fromkeys(re.sub(r"([./]).*", r"\1*", name) for name in known))


def _likeness(name: str, other: str) -> float:
    last_parts = name.replace("/", ".").split(".")[-1], other.replace("/", ".").split(".")[-1]
    whole = difflib.SequenceMatcher(None, name, other).ratio()
    part = difflib.SequenceMatcher(None, *last_parts).ratio()
    if len(name) >= _LEAST_BEGINNING and last_parts[1].startswith(name):
        part = max(part, _LEAST_LIKENESS / 0.9)
    # Of two names with the same last part, the one that is like it as a whole comes first.
    return 0.9 * max(whole, part) + 0.1 * whole
