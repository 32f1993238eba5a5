"""What every figure has to be: each text large enough, whole, and not upon another."""

from itertools import combinations
from unittest import mock

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text

from active_binocular_vision.figures.style import SMALLEST_PT, WIDTH_IN


def drawn_texts(figure: Figure) -> list[Text]:
    """Draw a figure; return its texts that can be seen."""
    with mock.patch.object(Text, "draw", autospec=True, side_effect=Text.draw) as draw:
        FigureCanvasAgg(figure).draw()
    texts = {id(call.args[0]): call.args[0] for call in draw.call_args_list}
    return [text for text in texts.values() if text.get_visible() and text.get_text().strip()]


def assert_readable(figure: Figure) -> None:
    """Raise AssertionError with a text that cannot be read on a page WIDTH_IN wide."""
    assert figure.get_figwidth() <= WIDTH_IN
    boxes = [(text, text.get_window_extent()) for text in drawn_texts(figure)]
    assert boxes
    for text, box in boxes:
        assert float(text.get_fontsize()) >= SMALLEST_PT, f"too small: {text.get_text()}"
        is_whole = box.x0 > -1 and box.y0 > -1
        is_whole &= box.x1 < figure.bbox.x1 + 1 and box.y1 < figure.bbox.y1 + 1
        assert is_whole, f"cut off: {text.get_text()}"
    for (one, its), (other, others) in combinations(boxes, 2):
        is_apart = min(its.x1, others.x1) - max(its.x0, others.x0) < 1
        is_apart |= min(its.y1, others.y1) - max(its.y0, others.y0) < 1
        assert is_apart, f"upon each other: {one.get_text()} and {other.get_text()}"
