"""The table that ends a run."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from experiment_manager.run import RESULTS_FILE
from experiment_manager.tables import tests_table


def results_table(results: Mapping[str, Any], directory: Path, figure: Path | None) -> str:
    """Return the tests of a results.json as text, and where everything lies."""
    return (
        f"\nmodel {results['model']}, seed {results['seed']}: "
        "tests by training iteration, after 20 iterations of each trial\n\n"
        f"{tests_table(results['tests'])}\n\n"
        f"results: {directory / RESULTS_FILE}\n"
        f"figure:  {figure or 'none'}\n"
        f"bag:     {directory / 'bag'}"
    )
