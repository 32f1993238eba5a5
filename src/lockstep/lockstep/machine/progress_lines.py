"""Progress on a terminal as a bar; in a log, which keeps what a bar would overwrite, as lines."""

import sys
from collections.abc import Iterable
from typing import Any, TextIO

from tqdm import tqdm

LINE_PERIOD_S = 10.0

_LINE = (
    "{desc}{n_fmt} of {total_fmt} {unit}, {percentage:.0f} %, {rate_fmt}, {remaining} left{postfix}"
)


class ProgressLines(tqdm):
    """tqdm that writes a line every ten seconds, and one at the end."""

    def __init__(self, iterable: Iterable[Any] | None = None, **options: Any) -> None:
        """options: tqdm's, except those of the bar's look and pace."""
        if desc := options.pop("desc", None):
            options["desc"] = f"{desc}: "  # as set_description has it
        # gui: tqdm itself draws nothing. miniters: the clock alone decides.
        options |= {"bar_format": _LINE, "gui": True, "miniters": 1, "mininterval": LINE_PERIOD_S}
        super().__init__(iterable, **options)

    def display(self, msg: str | None = None, pos: int | None = None) -> None:
        """Write a line."""
        self.write(str(self) if msg is None else msg, file=self.fp)

    def clear(self, nolock: bool = False) -> None:
        """Leave the lines that are written."""

    @classmethod
    def write(cls, s: str, file: Any = None, end: str = "\n", nolock: bool = False) -> None:
        """Write a line of other text."""
        stream = file or sys.stdout
        stream.write(s + end)
        stream.flush()

    def close(self) -> None:
        """Write the last line."""
        if not self.disable and self.n > self.last_print_n:
            self.display()
        super().close()


def progress(iterable: Iterable[Any] | None = None, *, file: TextIO, **options: Any) -> tqdm:
    """Return a bar of tqdm on a terminal, ProgressLines elsewhere."""
    if file.isatty():
        return tqdm(iterable, file=file, mininterval=1.0, dynamic_ncols=True, **options)
    return ProgressLines(iterable, file=file, **options)
