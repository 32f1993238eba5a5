"""What a person sees of a run while it is made."""

import os
import sys
from typing import TextIO

from tqdm import tqdm

from experiment_manager.protocol import Protocol
from lockstep.machine.lasting_output import lasting
from lockstep.machine.progress_lines import progress

# The number of an open file to draw on, from a parent whose standard error is not this process's.
TERMINAL_VARIABLE = "ABV_TERMINAL_FD"


def _terminal() -> TextIO:
    given = os.environ.get(TERMINAL_VARIABLE, "")
    return lasting(os.fdopen(int(given), "w") if given.isdigit() else sys.stderr)


class ProgressBar:
    """All iterations with rate, time left and running error, and a line per test."""

    def __init__(self, protocol: Protocol, place: int) -> None:
        """place: episodes already done. The bar appears with the first episode that is done."""
        self._protocol = protocol
        self._place = place
        self._terminal = _terminal()
        self._bar: tqdm | None = None

    def _started(self) -> tqdm:
        if self._bar is None:
            self._bar = progress(
                file=self._terminal,
                total=self._protocol.iterations_before(len(self._protocol)),
                initial=self._protocol.iterations_before(self._place),
                unit="it",
            )
        return self._bar

    def advance(self, running_median_error_deg: float | None) -> None:
        """Go on by one episode."""
        bar = self._started()
        is_test = self._protocol.segment(self._place).i_test >= 0
        self._place += 1
        notes = []
        if n_trials := self._protocol.trials_from(self._place):
            notes.append(f"{n_trials:,} test trials left")
        if running_median_error_deg is not None:
            notes.append(f"|error| {running_median_error_deg:.2f} deg")
        bar.set_postfix_str(", ".join(notes), refresh=False)
        bar.set_description("test" if is_test else "training", refresh=False)
        config = self._protocol.config
        bar.update(config.iterations_per_trial if is_test else config.iterations_per_episode)

    def say(self, text: str) -> None:
        """Print a line above the bar."""
        self._started().write(text, file=self._terminal)

    def close(self) -> None:
        """Leave the bar as it stands."""
        if self._bar is not None:
            self._bar.close()
