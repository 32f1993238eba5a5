"""What a terminal shows of tests."""

from typing import Any

from msgspec.structs import replace

from experiment_manager.measures.results import ActivePairs, Spread
from experiment_manager.measures.tables import in_words, summaries_table, summary_line
from tests.experiment_manager.summaries import summary

_OTHERS = {"median_abs_vertical_error_deg": 0.25, "median_abs_cyclovergence_error_deg": 1.5}


def test_errors_about_other_axes_are_shown_where_commands_turn_them() -> None:
    pair = summary(iteration=7, median_abs_vergence_error_deg=0.125)
    twelve = summary(iteration=7, median_abs_vergence_error_deg=0.125, **_OTHERS)
    assert "IQR - deg, |vertical| 0.250 deg, |cyclo| 1.500 deg, - within" in summary_line(twelve)
    assert "vertical" not in summary_line(pair)
    header, row = summaries_table([twelve]).splitlines()
    assert header.split()[2:6] == ["|vergence|/deg", "IQR/deg", "vertical/deg", "cyclo/deg"]
    assert row.split()[:6] == ["7", "0", "0.125", "-", "0.250", "1.500"]
    assert "vertical" not in summaries_table([pair])


def test_lines_fit_a_terminal_and_bars_take_what_room_there_is() -> None:
    wide: dict[str, Any] = {
        "n_trials": 1680,
        "share_within_1_px": 1.0,
        "median_cost_ratio": 30.22,
        "median_cost_reduction": -0.019,
        "antagonists_active": ActivePairs(1.0, 0.0, 0.0),
    }
    pair, twelve = (
        [
            summary(iteration=n, median_abs_vergence_error_deg=2.0, **wide, **others)
            for n in (0, 10**7)
        ]
        for others in ({}, _OTHERS)
    )
    lines = summaries_table(pair).splitlines()
    assert 100 < max(map(len, lines)) <= 120
    assert lines[1].endswith("100 / 0 / 0 %  " + lines[2].split()[-1])
    lines = summaries_table(twelve).splitlines()
    assert 100 < max(map(len, lines)) <= 120
    assert "#" not in lines[1], "there is no room"


def test_the_last_test_in_words() -> None:
    test = summary(
        iteration=50_000,
        median_abs_vergence_error_deg=0.05,
        share_within_1_px=0.9875,
        median_cost_reduction=0.97,
        median_cost_ratio=1.25,
        antagonists_active=ActivePairs(0.5, 0.255, 0.245),
    )
    said = " ".join(in_words(test, px_deg=0.2).split())
    assert "off by 0.25 px in the median, and by less than 1 px in 98.8 % of the trials" in said
    assert "1.25 times the least energy with which they could look there, and save 97.0 %" in said
    assert (
        "both are active at the end in 50.0 % of the cases, one in 25.5 %, none in 24.5 %" in said
    )
    assert in_words(summary(), px_deg=0.2) == ""


def test_no_saving_is_told_of_eyes_that_look_elsewhere() -> None:
    test = summary(
        median_abs_vergence_error_deg=1.4, share_within_1_px=0.12, median_cost_reduction=1.0
    )
    assert "100.0 %" not in in_words(test, px_deg=0.2)
    assert "the energy saved is not reported" in in_words(test, px_deg=0.2)
    assert "c - (0 trials)" in summary_line(test)
    assert summaries_table([test]).splitlines()[1].split()[-4:-1] == ["-", "-", "-"]


def test_no_saving_is_told_of_eyes_that_fuse_but_miss_their_targets() -> None:
    verging = summary(share_within_1_px=0.98, median_cost_reduction=1.2)
    there = {"after_1": Spread(0.5), "after_2": Spread(0.1)}
    missed = {"after_1": Spread(8.0), "after_2": Spread(7.9)}
    assert replace(verging, saccade_error_deg=there).saving == 1.2
    assert replace(verging, saccade_error_deg=missed).saving is None


def test_a_saving_that_nobody_knows_has_its_own_reason() -> None:
    test = summary(
        median_abs_vergence_error_deg=0.02, share_within_1_px=1.0, median_cost_reduction=None
    )
    assert "the energy saved is not known" in in_words(test, px_deg=0.2)
