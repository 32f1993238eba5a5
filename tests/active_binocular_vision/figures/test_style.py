"""The common style of figures, on axes without data of a run."""

import matplotlib as mpl
import pytest

from active_binocular_vision.figures.style import (
    STYLE,
    label_decades,
    mark_level,
    new_figure,
    panel_grid,
    title_panels,
)
from tests.readable import assert_readable, drawn_texts


@pytest.mark.parametrize(("level", "names"), [(0.3, ["1 px"]), (0.01, [])])
def test_a_level_is_named_where_it_is_in_sight(level: float, names: list[str]) -> None:
    with mpl.rc_context(STYLE):
        figure = new_figure(3.0, 2.0)
        axes = figure.subplots()
        axes.plot([0, 1], [0.2, 0.9])
        label_decades(axes)
        mark_level(axes, level, "1 px")
        assert_readable(figure)
    assert [text.get_text() for text in drawn_texts(figure) if "px" in text.get_text()] == names
    assert axes.get_ylim() == pytest.approx((0.1, 1.0))


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
