"""What tests and runs have measured, and results.json, which readers and scripts rely on."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, Self

from experiment_manager.measures.fixations import FixationMeasures
from lockstep import InputError
from lockstep.durable_files import replace_file

RESULTS_FILE = "results.json"
_AFTER = "after_"
_ANTAGONISTS = "antagonists"

Json = Mapping[str, Any]


@dataclass(frozen=True, kw_only=True)
class Measures:
    """Measures of some trials after one iteration, as in docs/measures.md.

    None where no trial counts. This class and those below have the names of results.json.
    """

    median_abs_vergence_error_deg: float | None
    iqr_abs_vergence_error_deg: float | None
    median_delta_cost_w: float | None
    median_cost_reduction: float | None
    share_within_1_px: float | None
    share_beyond_1_deg: float | None
    share_antagonist_silent: float | None
    # Only where commands turn the eyes about these axes.
    median_abs_vertical_error_deg: float | None = None
    iqr_abs_vertical_error_deg: float | None = None
    median_abs_cyclovergence_error_deg: float | None = None
    iqr_abs_cyclovergence_error_deg: float | None = None

    def to_json(self) -> dict[str, Any]:
        """Return the entries of results.json."""
        values = {f.name: getattr(self, f.name) for f in fields(Measures)}
        return {n: v for n, v in values.items() if v is not None or n not in _OTHER_AXES}

    @classmethod
    def from_json(cls, document: Json) -> Self:
        """Return what `to_json` was called on; KeyError, TypeError or ValueError for other data."""
        document = dict.fromkeys(_OTHER_AXES) | dict(document)
        return cls(**{f.name: _number(document[f.name]) for f in fields(Measures)})


_OTHER_AXES = [f.name for f in fields(Measures) if f.default is None]


@dataclass(frozen=True, kw_only=True)
class AntagonistPair:
    """How two antagonists of one eye share their work after the last iteration.

    share_silent: of trials in which one of both is silent; median_co_contraction: of the lesser
    activation of both; share_silent_by_distance: by object distance in m.
    """

    share_silent: float | None
    median_co_contraction: float | None
    share_silent_by_distance: Mapping[float, float | None]

    def to_json(self) -> dict[str, Any]:
        """Return the entries of results.json."""
        by_distance = {f"{d:g}": share for d, share in self.share_silent_by_distance.items()}
        return vars(self) | {"share_silent_by_distance": by_distance}

    @classmethod
    def from_json(cls, document: Json) -> Self:
        """Return what `to_json` was called on; errors as in Measures."""
        by_distance = document["share_silent_by_distance"].items()
        return cls(
            share_silent=_number(document["share_silent"]),
            median_co_contraction=_number(document["median_co_contraction"]),
            share_silent_by_distance={float(d): _number(share) for d, share in by_distance},
        )


@dataclass(frozen=True, kw_only=True)
class SetSummary(Measures):
    """Measures of a set of trials after their last iteration.

    bias_by_distance_deg: by object distance in m; after: of the iterations before the last one that
    are reported; antagonists: by name, of muscles that have commands of their own.
    """

    n_trials: int
    bias_by_distance_deg: Mapping[float, float | None]
    median_abs_version_deg: float | None
    median_left_deviation_deg: float | None
    median_right_deviation_deg: float | None
    after: Mapping[int, Measures]
    antagonists: Mapping[str, AntagonistPair] = field(default_factory=dict)

    def to_json(self) -> dict[str, Any]:
        """Return the entries of results.json."""
        return {
            "n_trials": self.n_trials,
            **super().to_json(),
            "bias_by_distance_deg": {f"{d:g}": b for d, b in self.bias_by_distance_deg.items()},
            "median_abs_version_deg": self.median_abs_version_deg,
            "median_left_deviation_deg": self.median_left_deviation_deg,
            "median_right_deviation_deg": self.median_right_deviation_deg,
            **{f"{_AFTER}{k}": measures.to_json() for k, measures in self.after.items()},
            **(
                {_ANTAGONISTS: {name: pair.to_json() for name, pair in self.antagonists.items()}}
                if self.antagonists
                else {}
            ),
        }

    @classmethod
    def from_json(cls, document: Json) -> Self:
        """Return what `to_json` was called on; errors as in Measures."""
        biases_deg = document["bias_by_distance_deg"].items()
        early = {k.removeprefix(_AFTER): v for k, v in document.items() if k.startswith(_AFTER)}
        return cls(
            **vars(Measures.from_json(document)),
            n_trials=int(document["n_trials"]),
            bias_by_distance_deg={float(d): _number(bias_deg) for d, bias_deg in biases_deg},
            median_abs_version_deg=_number(document["median_abs_version_deg"]),
            median_left_deviation_deg=_number(document["median_left_deviation_deg"]),
            median_right_deviation_deg=_number(document["median_right_deviation_deg"]),
            after={int(k): Measures.from_json(measures) for k, measures in early.items()},
            antagonists={
                name: AntagonistPair.from_json(pair)
                for name, pair in document.get(_ANTAGONISTS, {}).items()
            },
        )


@dataclass(frozen=True, kw_only=True)
class Summary(SetSummary):
    """Measures of one test: of all trials, and of fewer.

    iteration: of training; without_zero_start_error: of the trials that do not start with correct
    vergence; authors_test_set: of those that the authors' code has, too; fixations: of eyes that
    make saccades.
    """

    iteration: int
    without_zero_start_error: SetSummary
    authors_test_set: SetSummary
    fixations: FixationMeasures | None = None

    def to_json(self) -> dict[str, Any]:
        """Return the entries of results.json."""
        return {
            "iteration": self.iteration,
            **super().to_json(),
            **(self.fixations.to_json() if self.fixations else {}),
            "without_zero_start_error": self.without_zero_start_error.to_json(),
            "authors_test_set": self.authors_test_set.to_json(),
        }

    @classmethod
    def from_json(cls, document: Json) -> Self:
        """Return what `to_json` was called on; errors as in Measures."""
        return cls(
            **vars(SetSummary.from_json(document)),
            iteration=int(document["iteration"]),
            without_zero_start_error=SetSummary.from_json(document["without_zero_start_error"]),
            authors_test_set=SetSummary.from_json(document["authors_test_set"]),
            fixations=(
                FixationMeasures.from_json(document) if "saccade_error_deg" in document else None
            ),
        )


@dataclass(frozen=True, kw_only=True)
class Results:
    """What a run has measured.

    profile: named settings that the run began with, "" for none; iterations: of training;
    metabolic_cost_weight: lambda in 1/W; cost_share_first, ..._last: its share of the reward over
    the first and the last 5,000 training iterations, None where it is not known.
    """

    model: str
    profile: str
    seed: int
    iterations: int
    commit: str
    metabolic_cost_weight: float
    cost_share_first: float | None
    cost_share_last: float | None
    tests: tuple[Summary, ...]

    def to_json(self) -> dict[str, Any]:
        """Return what results.json holds."""
        return {
            "model": self.model,
            "profile": self.profile,
            "seed": self.seed,
            "iterations": self.iterations,
            "commit": self.commit,
            "lambda": self.metabolic_cost_weight,
            "lambda_share": {
                "first_5000": self.cost_share_first,
                "last_5000": self.cost_share_last,
            },
            "tests": [test.to_json() for test in self.tests],
        }

    @classmethod
    def from_json(cls, document: Json) -> Self:
        """Return what `to_json` was called on; errors as in Measures."""
        return cls(
            model=str(document["model"]),
            profile=str(document["profile"]),
            seed=int(document["seed"]),
            iterations=int(document["iterations"]),
            commit=str(document["commit"]),
            metabolic_cost_weight=float(document["lambda"]),
            cost_share_first=_number(document["lambda_share"]["first_5000"]),
            cost_share_last=_number(document["lambda_share"]["last_5000"]),
            tests=tuple(Summary.from_json(test) for test in document["tests"]),
        )


def _number(value: Any) -> float | None:
    return None if value is None else float(value)


def write_document(path: Path, document: Json) -> None:
    """Write what a `to_json` returned, as a whole.

    Raises ValueError for a number that is not finite, OSError when the disk refuses; then the
    older file is untouched.
    """
    replace_file(path, (json.dumps(document, indent=2, allow_nan=False) + "\n").encode())


def read_results(path: Path) -> Results:
    """Return the content of a results.json; InputError when it is missing or another thing."""
    try:
        document = json.loads(path.read_bytes())
    except OSError as error:
        raise InputError(f"expected {path}: {error.strerror}") from error
    except ValueError as error:
        raise InputError(f"{path}: expected JSON, got {error}") from error
    try:
        return Results.from_json(document)
    except KeyError as error:
        raise InputError(f"{path}: expected results with {error}, got none") from error
    except (AttributeError, TypeError, ValueError) as error:
        raise InputError(f"{path}: expected the results of a run: {error}") from error
