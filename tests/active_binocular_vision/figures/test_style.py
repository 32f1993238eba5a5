"""The common style of figures, on axes without data of a run."""

import os
import subprocess
import sys

import matplotlib as mpl
import pytest

from active_binocular_vision.figures.quartiles import scale_errors
from active_binocular_vision.figures.style import (
    label_decades,
    mark_level,
    new_figure,
    own_style,
    panel_grid,
    title_panels,
)
from tests.patience import PATIENCE_S
from tests.readable import assert_readable, drawn_texts


@pytest.mark.parametrize(("level", "names"), [(0.3, ["1 px"]), (0.01, [])])
def test_a_level_is_named_where_it_is_in_sight(level: float, names: list[str]) -> None:
    with own_style():
        figure = new_figure(3.0, 2.0)
        axes = figure.subplots()
        axes.plot([0, 1], [0.2, 0.9])
        label_decades(axes)
        mark_level(axes, level, "1 px")
        assert_readable(figure)
    assert [text.get_text() for text in drawn_texts(figure) if "px" in text.get_text()] == names
    assert axes.get_ylim() == pytest.approx((0.1, 1.0))


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("errors_deg", [[], [0.0, 0.0], [float("nan")]])
def test_what_is_never_above_0_has_no_decades(errors_deg: list[float]) -> None:
    figure = new_figure(3.0, 2.0)
    axes = figure.subplots()
    axes.plot(range(len(errors_deg)), errors_deg)
    scale_errors(axes, 0.2)
    figure.draw_without_rendering()
    assert axes.get_yscale() == "linear"


def test_panels_have_letters_and_the_rest_of_a_grid_is_empty() -> None:
    figure, panels = panel_grid(3, 2, 1.5)
    title_panels(panels, ["one", "", "three"])
    titles = [axes.get_title("left") for axes in panels]
    assert [title.split()[-1] for title in titles] == ["one", r"$\bf{b}$", "three"]
    assert [axes.axison for axes in figure.axes] == [True, True, True, False]


def test_text_that_cannot_be_read_is_found() -> None:
    figure = new_figure(3.0, 2.0)
    figure.text(0.5, 0.5, "one")
    other = figure.text(0.5, 0.5, "other")
    with pytest.raises(AssertionError, match="upon each other: one and other"):
        assert_readable(figure)
    other.set_position((0.5, 1.5))
    with pytest.raises(AssertionError, match="cut off: other"):
        assert_readable(figure)
    other.set(position=(0.5, 0.8), fontsize=6)
    with pytest.raises(AssertionError, match="too small: other"):
        assert_readable(figure)


def test_a_file_of_the_user_changes_no_figure() -> None:
    with mpl.rc_context({"text.usetex": True, "axes.grid": True}):
        with own_style():
            assert not mpl.rcParams["text.usetex"]
            assert not mpl.rcParams["axes.grid"]
        assert mpl.rcParams["text.usetex"]


_BACKEND = "import matplotlib, sys; print(matplotlib.get_backend(), file=sys.stderr)"
_OF_COMMAND = f"""
import sys
from active_binocular_vision.command_lines.parameters import main
sys.argv = ["abv parameters", "eye_plant"]
try:
    main()
finally:
    {_BACKEND}
"""
_OF_VALIDATION = f"""
import contextlib, io, sys
from eye_plant.validation.__main__ import main
with contextlib.redirect_stderr(io.StringIO()), contextlib.suppress(SystemExit):
    main(["--out", "/dev/null/x"])
{_BACKEND}
"""
_OF_NOTEBOOK = """
import os, sys, active_binocular_vision as abv, eye_plant.validation
abv.run
print(os.environ["MPLBACKEND"], file=sys.stderr)
"""
_INLINE = "module://matplotlib_inline.backend_inline"


@pytest.mark.parametrize(
    ("script", "backend"),
    [(_OF_COMMAND, "agg"), (_OF_VALIDATION, "agg"), (_OF_NOTEBOOK, _INLINE)],
    ids=["command", "validation", "notebook"],
)
def test_only_commands_draw_with_a_backend_of_their_own(script: str, backend: str) -> None:
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join(sys.path),
        "MPLBACKEND": _INLINE,
    }
    done = subprocess.run(
        [sys.executable, "-c", script],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=PATIENCE_S,
    )
    assert done.stderr == f"{backend}\n"
