"""results.json: these types are its format, which readers and scripts rely on."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from lockstep import InputError
from lockstep.files.durable_files import replace_file

RESULTS_FILE = "results.json"
# Eyes verge when at least this share of trials ends within one pixel, and look at targets when the
# median error after their last saccade is at most this.
_VERGING_SHARE = 0.5
_LOOKING_THERE_DEG = 1.0


class ActivePairs(msgspec.Struct, frozen=True):
    """Shares of pairs of antagonists of which both muscles are active, one is, or none."""

    both: float
    one: float
    none: float


class Measures(msgspec.Struct, kw_only=True, frozen=True, omit_defaults=True):
    """Measures of some trials after one iteration, as in docs/reference/measures.md.

    None where no trial counts.
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
    # Only of eyes with lenses, of the eye that is worse in focus.
    median_abs_accommodation_error_d: float | None = None
    share_within_quarter_d: float | None = None

    @property
    def verges(self) -> bool:
        """Whether half of the trials or more end within one pixel."""
        return (self.share_within_1_px or 0.0) >= _VERGING_SHARE

    @property
    def saving(self) -> float | None:
        """Median c of eyes that verge, None of others: to look elsewhere may cost less than C*."""
        return self.median_cost_reduction if self.verges else None


class AntagonistPair(msgspec.Struct, frozen=True, omit_defaults=True):
    """How two antagonists of one eye share their work after the last iteration.

    active: whether both, one or none of the two are; median_co_contraction: of the lesser
    activation of both; reciprocity_slope: of the lesser over the greater activation;
    active_by_distance: by object distance in m.
    """

    median_co_contraction: float | None
    # Not in older files.
    active: ActivePairs | None = None
    reciprocity_slope: float | None = None
    active_by_distance: dict[str, ActivePairs | None] = {}


class SetSummary(Measures, kw_only=True, frozen=True, omit_defaults=True):
    """Measures of a set of trials after their last iteration.

    bias_by_distance_deg: by object distance in m; after_1 to after_20: after so many iterations, of
    longer trials; antagonists_active: of all pairs; antagonists: by the names of both;
    median_active_muscles: only of muscles that have commands of their own.
    """

    n_trials: int
    bias_by_distance_deg: dict[str, float | None]
    median_abs_version_deg: float | None
    median_left_deviation_deg: float | None
    median_right_deviation_deg: float | None
    median_metabolic_rate_w: float | None
    after_1: Measures | None = None
    after_2: Measures | None = None
    after_3: Measures | None = None
    after_20: Measures | None = None
    antagonists: dict[str, AntagonistPair] = {}
    # Not in older files.
    median_cost_ratio: float | None = None
    antagonists_active: ActivePairs | None = None
    median_active_muscles: float | None = None

    @property
    def after(self) -> dict[int, Measures]:
        """Measures by iteration, of the iterations before the last one that are reported."""
        found = {1: self.after_1, 2: self.after_2, 3: self.after_3, 20: self.after_20}
        return {k: measures for k, measures in found.items() if measures is not None}


class Spread(msgspec.Struct, frozen=True):
    """Median and 90th percentile of absolute values, None where it is not kept."""

    median: float
    p90: float | None = None

    @classmethod
    def of(cls, values: np.ndarray) -> "Spread":
        """Return those of values (n,), n > 0."""
        median, p90 = np.quantile(np.abs(values), (0.5, 0.9)).tolist()
        return cls(median, p90)


class Summary(SetSummary, kw_only=True, frozen=True, omit_defaults=True):
    """Measures of one test: of all trials, and of fewer.

    iteration: of training; without_zero_start_error: of the trials that do not start with correct
    vergence; starts_up_to_2_deg: of those that start at -3, -2, -1, 1 or 2 deg.

    Of eyes that make saccades the measures of fixations, as in docs/reference/measures.md.
    saccade_error_deg: angle between the leading eye's line of sight and the target after each of
    the saccades; gaze_drift_deg: how far that line moves over some iterations of vergence; what
    comes next: errors about all axes after those, the share of fixations within one pixel, sideways
    and up, and the share in which the right eye leads.
    """

    iteration: int
    without_zero_start_error: SetSummary
    starts_up_to_2_deg: SetSummary
    saccade_error_deg: dict[str, Spread] = {}
    gaze_drift_deg: Spread | None = None
    fixated_horizontal_error_deg: Spread | None = None
    fixated_vertical_error_deg: Spread | None = None
    fixated_cyclovergence_error_deg: Spread | None = None
    share_fixated_within_1_px: float | None = None
    share_right_eye_leads: float | None = None

    @property
    def verges(self) -> bool:
        """Whether the eyes verge and, of those that make saccades, look at their targets."""
        saccades = [*self.saccade_error_deg.values()]
        looks_there = not saccades or saccades[-1].median <= _LOOKING_THERE_DEG
        return super().verges and looks_there

    @property
    def fixation_spreads(self) -> tuple[Spread, ...]:
        """All spreads in the order of the fields; none of eyes that make no saccades."""
        spreads = (
            *self.saccade_error_deg.values(),
            self.gaze_drift_deg,
            self.fixated_horizontal_error_deg,
            self.fixated_vertical_error_deg,
            self.fixated_cyclovergence_error_deg,
        )
        return tuple(spread for spread in spreads if spread is not None)


class CostShares(msgspec.Struct, frozen=True):
    """Lambda's share of the reward over so many training iterations; None where not known."""

    first_5000: float | None
    last_5000: float | None


class Results(msgspec.Struct, kw_only=True, frozen=True):
    """What a run has measured.

    profile: named settings that the run began with, "" for none; iterations: of training;
    metabolic_cost_weight: lambda in 1/W.
    """

    model: str
    profile: str
    seed: int
    iterations: int
    commit: str
    metabolic_cost_weight: float = msgspec.field(name="lambda")
    cost_shares: CostShares = msgspec.field(name="lambda_share")
    tests: tuple[Summary, ...]


def write_document(path: Path, document: msgspec.Struct | Mapping[str, Any]) -> None:
    """Write results, or other values, as JSON; null stands for a number that is not finite.

    Raises OSError when the disk refuses; then the older file is untouched.
    """
    text = msgspec.json.format(msgspec.json.encode(document), indent=2)
    replace_file(path, text + b"\n")


def with_names_of_today(document: bytes) -> bytes:
    """Return a document with today's name of what older files call otherwise."""
    return document.replace(b'"authors_test_set":', b'"starts_up_to_2_deg":')


class _Tests(msgspec.Struct):
    tests: tuple[Summary, ...] = ()


def read_tests(path: Path) -> tuple[Summary, ...]:
    """Return the tests in a document of abv examine, none of another; InputError for no JSON."""
    try:
        return msgspec.json.decode(with_names_of_today(path.read_bytes()), type=_Tests).tests
    except (OSError, msgspec.DecodeError) as error:
        raise InputError(f"{path}: expected what abv examine writes: {error}") from error


def read_results(path: Path) -> Results:
    """Return the content of a results.json; InputError when it is missing or another thing."""
    try:
        return msgspec.json.decode(with_names_of_today(path.read_bytes()), type=Results)
    except OSError as error:
        raise InputError(f"expected {path}: {error.strerror}") from error
    except msgspec.DecodeError as error:
        raise InputError(f"{path}: expected the results of a run: {error}") from error
