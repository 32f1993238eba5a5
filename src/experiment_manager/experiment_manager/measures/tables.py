"""Plain text tables for a terminal."""

from collections.abc import Sequence

from experiment_manager.measures.results import ActivePairs, Summary

_BAR_WIDTH, _LEAST_BAR_WIDTH = 20, 5
# Characters of a line of the learning curve.
_LINE_WIDTH = 120
# Where fewer pairs of antagonists have an active muscle, the eyes rest.
_RESTING_SHARE = 0.5
_NO_TRUTH = (
    "The plant does not say where its cameras should look: no errors are reported.\n"
    "  The reconstruction errors in the bag show what was learned (docs/how_to/own_head.md)."
)


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
    if test.n_trials and test.median_abs_vergence_error_deg is None:
        return f"test at {test.iteration} iterations: {test.n_trials} trials, errors not known"
    others = "".join(f"|{name}| {number(value)} deg, " for name, value in _other_errors_deg(test))
    return (
        f"test at {test.iteration} iterations: "
        f"median |vergence error| {number(test.median_abs_vergence_error_deg)} deg, "
        f"IQR {number(test.iqr_abs_vergence_error_deg)} deg, {others}"
        f"{percent(test.share_within_1_px)} within 1 px"
        f"{f', c {number(test.saving)}' if _has_muscles(test) else ''} ({test.n_trials} trials)"
    )


def _has_muscles(test: Summary) -> bool:
    """Return whether what is commanded has a metabolic rate."""
    return test.median_metabolic_rate_w is not None


def in_words(test: Summary, px_deg: float) -> str:
    """Return what the learners of one test can do, in sentences; px_deg: visual angle of a pixel.

    Without a trial, "".
    """
    error_deg = test.median_abs_vergence_error_deg
    if error_deg is None:
        return _NO_TRUTH if test.n_trials else ""
    sentences = [
        f"After {test.iteration:,} training iterations, on stimuli that training never shows:",
        f"vergence is off by {number(error_deg / px_deg, 2)} px in the median, and by less than "
        f"1 px in {percent(test.share_within_1_px)} of the trials"
        + (";" if _has_muscles(test) else "."),
        *_saving_in_words(test),
        *_activity_in_words(test.antagonists_active),
        *_saccades_in_words(test),
    ]
    return "\n  ".join(sentences)


def _saving_in_words(test: Summary) -> list[str]:
    """Return what the eyes save, if they verge: others may spend less than correct gaze takes."""
    if not _has_muscles(test):
        return []
    if not test.verges:
        return ["the energy saved is not reported, because too few trials end that close;"]
    if test.saving is None:
        return ["the energy saved is not known: C* is unknown, or the trials begin with it;"]
    return [
        f"the eyes spend {number(test.median_cost_ratio, 2)} times the least energy with which "
        f"they could look there, and save {percent(test.saving)} of what they could save (medians);"
    ]


def _activity_in_words(active: ActivePairs | None) -> list[str]:
    """Return how antagonists share their work; with no active muscle the eyes merely rest."""
    if active is None:
        return []
    both, one, none = (percent(share) for share in (active.both, active.one, active.none))
    said = (
        f"of two antagonists both are active at the end in {both} of the cases, one in {one}, "
        f"none in {none}."
    )
    if active.none < _RESTING_SHARE:
        return [said]
    return [said, "Most pairs rest then, which costs least and is not reciprocal innervation."]


def active_text(active: ActivePairs | None) -> str:
    """Return shares of antagonists of which both, one or none is active, in percent, or a dash."""
    if active is None:
        return "-"
    shares = (number(100 * share, 0) for share in (active.both, active.one, active.none))
    return f"{' / '.join(shares)} %"


def _saccades_in_words(test: Summary) -> list[str]:
    """Return what saccades reach, of eyes that make them."""
    if test.gaze_drift_deg is None:
        return []
    after_1, after_2 = (s.median for s in test.saccade_error_deg.values())
    cyclo = test.fixated_cyclovergence_error_deg
    cyclo_deg = None if cyclo is None else cyclo.median
    return [
        f"Saccades miss their target by {number(after_1)} deg in the median, by {number(after_2)} "
        "deg after a second, corrective one;",
        f"gaze moves by {number(test.gaze_drift_deg.median)} deg while the eyes verge, after "
        f"which {percent(test.share_fixated_within_1_px)} of the fixations are within 1 px",
        f"and cyclovergence is off by {number(cyclo_deg)} deg in the median.",
    ]


def _other_errors_deg(test: Summary) -> list[tuple[str, float | None]]:
    """Return the names of other axes with the median errors about them, of the pair none."""
    if test.median_abs_vertical_error_deg is None:
        return []
    return [
        ("vertical", test.median_abs_vertical_error_deg),
        ("cyclo", test.median_abs_cyclovergence_error_deg),
    ]


def summaries_table(tests: Sequence[Summary]) -> str:
    """Return the learning curve of a run, one line of at most 120 characters per test.

    There are no columns for errors that nobody knows, and none for muscles where there are none.
    """
    errors_deg = [test.median_abs_vergence_error_deg or 0.0 for test in tests]
    most = max(errors_deg, default=0.0) or 1.0
    knows_errors, has_muscles = any(errors_deg), any(map(_has_muscles, tests))
    rows: list[dict[str, str]] = []
    for test in tests:
        row = {"iteration": str(test.iteration), "trials": str(test.n_trials)}
        if knows_errors:
            row["|vergence|/deg"] = number(test.median_abs_vergence_error_deg)
            row["IQR/deg"] = number(test.iqr_abs_vergence_error_deg)
            row |= {f"{name}/deg": number(value) for name, value in _other_errors_deg(test)}
            row["within 1 px"] = percent(test.share_within_1_px)
        if has_muscles:
            row["C/C*"] = number(test.median_cost_ratio if test.verges else None, 2)
            row["c"] = number(test.saving)
            row["both/one/none active"] = active_text(test.antagonists_active)
        rows.append(row)
    header = [*max(rows, key=len, default={"iteration": "", "trials": ""})]
    cells = [[row.get(name, "-") for name in header] for row in rows]
    lines = text_table(header, cells, n_left=0).splitlines()
    room = min(_BAR_WIDTH, _LINE_WIDTH - 2 - max(map(len, lines)))
    width = room if room >= _LEAST_BAR_WIDTH else 0
    bars = ["", *("#" * round(width * error_deg / most) for error_deg in errors_deg)]
    return "\n".join(f"{line}  {bar}".rstrip() for line, bar in zip(lines, bars, strict=True))
