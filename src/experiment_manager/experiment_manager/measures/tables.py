"""Plain text tables for a terminal."""

from collections.abc import Sequence

from experiment_manager.measures.results import Summary

_BAR_WIDTH = 20


def text_table(header: Sequence[str], rows: Sequence[Sequence[str]], n_left: int = 1) -> str:
    """Return a table with aligned columns; the first n_left are flush left, the others right."""
    lines = [header, *rows]
    widths = [max(len(line[i]) for line in lines) for i in range(len(header))]

    def cell(text: str, i: int) -> str:
        return text.ljust(widths[i]) if i < n_left else text.rjust(widths[i])

    return "\n".join(
        "  ".join(cell(text, i) for i, text in enumerate(line)).rstrip() for line in lines
    )


def number(value: float | None, n_digits: int = 3) -> str:
    """Return a number with n_digits behind the point, or a dash."""
    # Adding 0 makes what rounds to -0.0 a plain 0.
    return "-" if value is None else f"{round(value, n_digits) + 0.0:.{n_digits}f}"


def percent(share: float | None) -> str:
    """Return a share in percent, or a dash."""
    return "-" if share is None else f"{number(100 * share, 1)} %"


def summary_line(test: Summary) -> str:
    """Return the measures of one test in one line."""
    others = "".join(f"{name} {number(value)} deg, " for name, value in _other_errors_deg(test))
    return (
        f"test at {test.iteration} iterations: "
        f"median |vergence error| {number(test.median_abs_vergence_error_deg)} deg, "
        f"IQR {number(test.iqr_abs_vergence_error_deg)} deg, {others}"
        f"{percent(test.share_within_1_px)} within 1 px, "
        f"c {number(test.saving)} ({test.n_trials} trials)"
    )


def in_words(test: Summary, px_deg: float) -> str:
    """Return what the learners of one test can do, in sentences; px_deg: visual angle of a pixel.

    Without a trial whose error is known, "".
    """
    error_deg = test.median_abs_vergence_error_deg
    if error_deg is None:
        return ""
    antagonist = (
        "one horizontal rectus of an eye"
        if test.antagonists
        else "the antagonist (the lateral rectus for near objects, the medial one for far ones)"
    )
    sentences = [
        f"After {test.iteration:,} training iterations, on pictures that training never shows:",
        f"vergence is off by {number(error_deg / px_deg, 2)} px in the median, and by less than "
        f"1 px in {percent(test.share_within_1_px)} of the trials;",
        _saving_in_words(test),
        f"{antagonist} is silent in {percent(test.share_antagonist_silent)}.",
        *_saccades_in_words(test),
    ]
    return "\n  ".join(sentences)


def _saving_in_words(test: Summary) -> str:
    """Return what the eyes save, if they verge: others may spend less than correct gaze takes."""
    if not test.verges:
        return "the energy saved is not reported, because too few trials end that close;"
    if test.saving is None:
        return "the energy saved is not known: C* is unknown, or the trials begin with it;"
    return (
        f"the eyes spend {number(test.median_cost_ratio, 2)} times the least energy with which "
        f"they could look there, and save {percent(test.saving)} of what they could save (medians);"
    )


def _saccades_in_words(test: Summary) -> list[str]:
    """Return what saccades reach, of eyes that make them."""
    if test.gaze_drift_deg is None:
        return []
    after_1, after_2 = (s.median for s in test.saccade_error_deg.values())
    return [
        f"Saccades miss their target by {number(after_1)} deg in the median, by {number(after_2)} "
        "deg after a second, corrective one;",
        f"gaze moves by {number(test.gaze_drift_deg.median)} deg while the eyes verge, after "
        f"which {percent(test.share_fixated_within_1_px)} of the fixations are within 1 px.",
    ]


def _other_errors_deg(test: Summary) -> list[tuple[str, float | None]]:
    """Return the median errors about other axes with their names, of the pair none."""
    if test.median_abs_vertical_error_deg is None:
        return []
    return [
        ("|vertical|", test.median_abs_vertical_error_deg),
        ("|cyclovergence|", test.median_abs_cyclovergence_error_deg),
    ]


def summaries_table(tests: Sequence[Summary]) -> str:
    """Return the learning curve of a run, one line per test."""
    others = [_other_errors_deg(test) for test in tests]
    errors_deg = [test.median_abs_vergence_error_deg or 0.0 for test in tests]
    most = max(errors_deg, default=0.0) or 1.0
    header = ["iteration", "trials", "|vergence error|/deg", "IQR/deg"]
    header += [f"{name}/deg" for name, _ in max(others, key=len, default=[])]
    header += ["within 1 px", "beyond 1 deg", "delta C/W", "c", "silent", ""]
    rows = [
        (
            str(test.iteration),
            str(test.n_trials),
            number(test.median_abs_vergence_error_deg),
            number(test.iqr_abs_vergence_error_deg),
            *(number(value) for _, value in of_test),
            percent(test.share_within_1_px),
            percent(test.share_beyond_1_deg),
            number(test.median_delta_cost_w),
            number(test.saving),
            percent(test.share_antagonist_silent),
            ("#" * round(_BAR_WIDTH * error_deg / most)).ljust(_BAR_WIDTH),
        )
        for test, error_deg, of_test in zip(tests, errors_deg, others, strict=True)
    ]
    return text_table(header, rows, n_left=0)
