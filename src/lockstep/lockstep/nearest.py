"""The known names that somebody who mistyped one may have meant."""

import difflib
from collections.abc import Iterable

_MOST = 3
_LEAST_LIKENESS = 0.6


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


def meant(name: str, known: Iterable[str]) -> str:
    """Return the same question, or "; expected one of ..." with all names if none is near."""
    return did_you_mean(name, known) or f"; expected one of {', '.join(sorted(known))}"


def _likeness(name: str, other: str) -> float:
    last_parts = name.replace("/", ".").split(".")[-1], other.replace("/", ".").split(".")[-1]
    whole = difflib.SequenceMatcher(None, name, other).ratio()
    # Of two names with the same last part, the one that is like it as a whole comes first.
    return 0.9 * max(whole, difflib.SequenceMatcher(None, *last_parts).ratio()) + 0.1 * whole
