"""Conditions of runs that were made up: their names, measures over seeds, columns."""

import pytest

from active_binocular_vision.examinations.registry import EXAMINATIONS
from active_binocular_vision.runs.conditions import Range, chosen_columns, conditions_of
from active_binocular_vision.runs.examined_run import BEFORE, BIRTH, END, ages_of
from lockstep import InputError
from tests.active_binocular_vision.made_examined import column, examined, summaries


@pytest.mark.parametrize(
    ("tested", "changed_at", "ages"),
    [
        ([0, 100], None, {BIRTH: 0, END: 100}),
        ([0, 40, 100], 40, {BIRTH: 0, BEFORE: 40, END: 100}),
        ([0, 20, 40, 60, 100], 50, {BIRTH: 0, BEFORE: 40, END: 100}),
        ([0, 40, 100], 30, {BIRTH: 0, END: 100}),
        ([40, 100], None, {END: 100}),
    ],
)
def test_the_ages_that_a_run_was_tested_at(tested, changed_at, ages) -> None:
    assert ages_of(tested, changed_at) == ages


def test_seeds_are_one_condition_and_what_differs_is_in_its_name() -> None:
    runs = [
        examined("surgery", changed_at=(at,), final_learning_rate=rate, seed=seed)
        for seed in (1, 2)
        for at in (200, 1200)
        for rate in (0.0, 0.2)
    ]
    found = conditions_of([*runs, examined("patching_half", model="M_C")])
    assert [(of.name.replace("\N{NO-BREAK SPACE}", " "), len(of.runs)) for of in found] == [
        ("surgery, at 10 %, frozen, M", 2),
        ("surgery, at 10 %, plastic, M", 2),
        ("surgery, at 60 %, frozen, M", 2),
        ("surgery, at 60 %, plastic, M", 2),
        ("glasses, patching half, M_C", 1),
    ]
    assert [of.name for of in conditions_of([examined("vertical")])] == ["vertical stripes"]


def test_runs_with_other_settings_or_another_price_are_conditions_of_their_own() -> None:
    runs = [
        examined(seed=seed, settings={"memory_share": share}) for share in (1, 2) for seed in (1, 2)
    ]
    found = conditions_of(runs)
    assert [of.name for of in found] == ["healthy, memory_share 1", "healthy, memory_share 2"]
    assert [of.runs for of in found] == [tuple(runs[:2]), tuple(runs[2:])]
    priced = conditions_of([examined(weight=weight) for weight in (0.1, 0.3)])
    assert [of.name for of in priced] == ["healthy, λ = 0.1 / W", "healthy, λ = 0.3 / W"]


def test_a_measure_over_the_seeds_that_have_it() -> None:
    (condition,) = conditions_of(
        [
            examined(seed=seed, found={END: summaries(stereo__threshold_arcsec=value)})
            for seed, value in enumerate((0.2, None, 0.6, 0.3))
        ]
    )
    stereo, fused = column("stereo.threshold_arcsec"), column("cover.share_fused")
    found = condition.over_seeds(END, stereo)
    assert found == Range(0.3, 0.2, 0.6, 3)
    assert condition.over_seeds(BIRTH, fused) is None
    assert stereo.cell(found, 4) == "0 (0 to 1; 3 of 4)"
    assert fused.cell(condition.over_seeds(END, fused), 4) == "50 (50 to 50)"
    assert fused.cell(None, 4) == "-"


def test_columns_are_chosen_by_examination_or_one_by_one() -> None:
    chosen = [f"{c.examination}.{c.measure}" for c in chosen_columns("cover,test.error_deg")]
    assert chosen == [
        "cover.horizontal_deviation_pd",
        "cover.vertical_deviation_pd",
        "cover.share_fused",
        "test.error_deg",
    ]
    assert {c.examination for c in chosen_columns(",".join(EXAMINATIONS))} == set(EXAMINATIONS)
    with pytest.raises(InputError, match=r"got 'cover\.fused'; did you mean cover\.share_fused"):
        chosen_columns("cover.fused")
