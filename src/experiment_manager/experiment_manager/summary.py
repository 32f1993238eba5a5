"""The table that ends a run."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

_COLUMNS = (
    ("iteration", "iterations", "{:>10d}"),
    ("n_trials", "trials", "{:>7d}"),
    ("median_abs_vergence_error_deg", "median |error| deg", "{:>19.3f}"),
    ("iqr_abs_vergence_error_deg", "IQR deg", "{:>9.3f}"),
    ("median_delta_cost_w", "Delta C W", "{:>10.3f}"),
    ("median_cost_reduction", "c", "{:>7.3f}"),
)


def results_table(results: Mapping[str, Any], directory: Path, figure: Path) -> str:
    """Return the tests of a results.json as text, and where everything lies."""
    widths = [len(form.format(0)) for _, _, form in _COLUMNS]
    lines = [
        "",
        f"model {results['model']}, seed {results['seed']}: tests, after 20 iterations of a trial",
        " ".join(title.rjust(width) for (_, title, _), width in zip(_COLUMNS, widths, strict=True)),
    ]
    lines += [
        " ".join(_cell(test[key], form) for key, _, form in _COLUMNS) for test in results["tests"]
    ]
    lines += [
        "",
        f"results: {directory / 'results.json'}",
        f"figure:  {figure}",
        f"bag:     {directory / 'bag'}",
    ]
    return "\n".join(lines)


def _cell(value: float | None, form: str) -> str:
    """Return a number in its form; a test of few trials may have no cost reduction."""
    return "-".rjust(len(form.format(0))) if value is None else form.format(value)
