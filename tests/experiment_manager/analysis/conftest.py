from collections.abc import Iterator

import matplotlib as mpl
import pytest

from lockstep.figures import STYLE


@pytest.fixture(autouse=True)
def style() -> Iterator[None]:
    """Figures are drawn as the commands draw them."""
    with mpl.rc_context(STYLE):
        yield
