"""results.json: what a run has measured, in the form that readers and scripts rely on."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from lockstep.durable_files import replace_file
from lockstep.errors import InputError

RESULTS_FILE = "results.json"


def results_document(
    *,
    model: str,
    profile: str,
    seed: int,
    iterations: int,
    commit: str,
    metabolic_cost_weight: float,
    cost_share_first: float | None,
    cost_share_last: float | None,
    tests: Sequence[dict[str, Any]],
) -> dict[str, Any]:
    """Return what results.json holds.

    profile: named settings that the run began with, "" for none; iterations: of training;
    metabolic_cost_weight: lambda in 1/W; cost_share_first, ..._last: its share of the reward over
    the first and the last 5,000 training iterations; tests: one metrics.summary per test.
    """
    return {
        "model": model,
        "profile": profile,
        "seed": seed,
        "iterations": iterations,
        "commit": commit,
        "lambda": metabolic_cost_weight,
        "lambda_share": {"first_5000": cost_share_first, "last_5000": cost_share_last},
        "tests": list(tests),
    }


def write_results(path: Path, **values: Any) -> None:
    """Write results.json as a whole; values as for results_document.

    Raises ValueError for a number that is not finite, OSError when the disk refuses; then the
    older file is untouched.
    """
    write_document(path, results_document(**values))


def write_document(path: Path, document: dict[str, Any]) -> None:
    """Write what results_document returned; errors as for write_results."""
    replace_file(Path(path), (json.dumps(document, indent=2, allow_nan=False) + "\n").encode())


def read_results(path: Path) -> dict[str, Any]:
    """Return the content of a results.json; InputError when it is missing or another thing."""
    try:
        document = json.loads(Path(path).read_bytes())
    except OSError as error:
        raise InputError(f"expected {path}: {error.strerror}") from error
    except ValueError as error:
        raise InputError(f"{path}: expected JSON, got {error}") from error
    expected = {"model", "seed", "iterations", "commit", "lambda", "lambda_share", "tests"}
    if not isinstance(document, dict) or not expected <= set(document):
        raise InputError(f"{path}: expected {', '.join(sorted(expected))}")
    return document
