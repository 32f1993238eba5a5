"""Summaries of tests as tests need them: some measures, all else absent."""

from typing import Any

import msgspec

from experiment_manager.measures.results import SetSummary, Summary

_EMPTY: dict[str, Any] = {
    **{field.name: None for field in msgspec.structs.fields(SetSummary) if field.required},
    "n_trials": 0,
    "bias_by_distance_deg": {},
}
NO_TRIALS = SetSummary(**_EMPTY)


def summary(**values: Any) -> Summary:
    """Return a summary with the given measures, of no trials where not said otherwise."""
    sets = {"without_zero_start_error": NO_TRIALS, "starts_up_to_2_deg": NO_TRIALS}
    # Of muscles; joints have no rate.
    of_test = {"iteration": 0, "median_metabolic_rate_w": 1.0}
    return Summary(**(_EMPTY | of_test | sets | values))
