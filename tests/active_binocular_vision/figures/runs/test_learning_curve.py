"""The learning curve shows the numbers of the tests: they are read back from the axes."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from msgspec.structs import replace

from active_binocular_vision import Run, groups_of
from active_binocular_vision.figures.runs.learning_curve import (
    learning_curve,
    learning_curve_figure,
    performance_figure,
)
from experiment_manager import summary_of
from tests.active_binocular_vision.changed_runs import priced, with_errors


def test_fig_2_shows_the_medians_of_the_tests(runs: list[Run]) -> None:
    errors, deltas = performance_figure(groups_of(runs)).axes
    shown = zip(_points(errors), _points(deltas), runs, strict=True)
    for (at, medians_deg), (_, medians_w), run in shown:
        # Points of two models stand beside each other.
        assert np.allclose(at, [0, 130, 270, 400], atol=4)
        assert np.allclose(
            medians_deg,
            [np.median(np.abs(t.vergence_error_deg[:, 20])) for t in run.tests.values()],
        )
        tests = run.tests.values()
        assert np.allclose(medians_w, [np.median(test.delta_cost_w(20)) for test in tests])
    assert errors.get_yscale() == "log"
    assert "deg" in errors.get_ylabel()
    assert "W" in deltas.get_ylabel()


def _points(axes: Axes) -> list[tuple[np.ndarray, np.ndarray]]:
    """The points of all tests, (n,) iterations and values, that no line joins."""
    lines = [line for line in axes.lines if line.get_linestyle() == "None"]
    return [(np.asarray(line.get_xdata()), np.asarray(line.get_ydata())) for line in lines]


def test_training_is_drawn_behind_the_tests_of_a_run(runs: list[Run]) -> None:
    errors, deltas = learning_curve_figure(runs[0]).axes
    curve = runs[0].recorded.training_curve
    for axes, quartiles in ((errors, curve.quartiles_deg), (deltas, curve.quartiles_w)):
        assert np.array_equal(axes.lines[0].get_xdata(), curve.iteration)
        assert np.array_equal(axes.lines[0].get_ydata(), quartiles[1])


def test_the_learning_curve_is_a_picture_in_the_run(run_directories: dict[str, Path]) -> None:
    path = learning_curve(run_directories["M"])
    assert path == run_directories["M"] / "figures" / "learning_curve.png"
    assert path.read_bytes().startswith(b"\x89PNG")


def test_many_tests_are_joined_with_each_seed_thin_behind_the_pooled_median(
    runs: list[Run], monkeypatch: pytest.MonkeyPatch
) -> None:
    for module in ("runs.learning_curve", "quartiles"):
        name = f"active_binocular_vision.figures.{module}.LEAST_JOINED"
        monkeypatch.setattr(name, 4)
    worse = _worse(runs[0], 3)
    groups = groups_of([runs[0], worse])
    assert len(groups) == 1
    pooled, *seeds = performance_figure(groups).axes[0].lines[:3]
    finals_deg = [run.tests[400].vergence_error_deg[:, 20] for run in (runs[0], worse)]
    both = np.abs(np.concatenate(finals_deg))
    assert np.asarray(pooled.get_ydata())[-1] == pytest.approx(np.median(both))
    ends = [float(np.asarray(line.get_ydata())[-1]) for line in seeds]
    single = float(np.median(np.abs(runs[0].tests[400].vergence_error_deg[:, 20])))
    assert ends == pytest.approx([single, 3 * single])
    assert all(line.get_linewidth() < pooled.get_linewidth() for line in seeds)


@pytest.mark.parametrize(("factors", "half"), [((1, 2, 3), 2.484138), ((1, 3), None)])
def test_of_three_seeds_or_more_the_interval_is_drawn(
    runs: list[Run], factors: tuple[int, ...], half: float | None
) -> None:
    # Student's t of 2 degrees of freedom, 4.302653, times SD 1 over the root of 3.
    seeds = [_worse(runs[0], factor) for factor in factors]
    errors, _ = performance_figure(groups_of(seeds)).axes
    assert len(errors.containers) == (half is not None)
    if half is None:
        return
    # Bars of quartiles, then of the interval.
    _, interval = (c for c in errors.collections if isinstance(c, LineCollection))
    ends_deg = interval.get_segments()[-1][:, 1]
    single_deg = float(np.median(np.abs(runs[0].tests[400].vergence_error_deg[:, 20])))
    assert ends_deg / single_deg == pytest.approx([2.0 - half, 2.0 + half])


def _worse(run: Run, factor: float) -> Run:
    """A run whose errors are multiplied."""
    worse = priced(run, 0.0, factor)
    criteria = worse.evaluation_settings.criteria
    tests = tuple(summary_of(t, criteria(at)) for at, t in worse.tests.items())
    worse.document = replace(worse.document, tests=tests)
    return worse


@pytest.mark.parametrize("factor", [0.001, 1.0, 1.02])
def test_fig_2_always_has_two_labelled_ticks_below(runs: list[Run], factor: float) -> None:
    # Errors that hardly differ, far from any power of ten.
    flat = priced(runs[0], 0.0, factor)
    flat.tests = {
        at: with_errors(test, np.full((39, 21), 0.3 * factor)) for at, test in flat.tests.items()
    }
    lower = performance_figure(groups_of([flat])).axes[0]
    low, high = lower.get_ylim()
    labels = [t.get_text() for t in lower.get_yticklabels() if low <= t.get_position()[1] <= high]
    assert len([label for label in labels if label]) >= 2
