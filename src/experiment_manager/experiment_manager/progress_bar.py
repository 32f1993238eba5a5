"""What a person sees of a run while it goes on."""

import sys

from tqdm import tqdm

from experiment_manager.protocol import Protocol


class ProgressBar:
    """A bar over all iterations with rate, time left and running error, and a line per test."""

    def __init__(self, protocol: Protocol, place: int) -> None:
        """place: episodes already done."""
        self._protocol = protocol
        self._place = place
        self._bar = tqdm(
            total=self._iterations_before(len(protocol)),
            initial=self._iterations_before(place),
            unit="it",
            file=sys.stderr,
            # Often enough for a person, seldom enough for a log file.
            mininterval=1.0 if sys.stderr.isatty() else 30.0,
            dynamic_ncols=True,
        )

    def _iterations_before(self, place: int) -> int:
        if place == 0:
            return 0
        episode = self._protocol.episode(place - 1)
        # Each episode has one observation more than it has iterations.
        return episode.first_observation + episode.n_iterations + 1 - place

    def advance(self, running_median_error_deg: float | None) -> None:
        """Go on by one episode."""
        self._place += 1
        config = self._protocol.config
        is_test = self._protocol.segment(self._place - 1).i_test >= 0
        if running_median_error_deg is not None:
            self._bar.set_postfix_str(f"|error| {running_median_error_deg:.2f} deg", refresh=False)
        self._bar.set_description("test" if is_test else "training", refresh=False)
        self._bar.update(config.iterations_per_trial if is_test else config.iterations_per_episode)

    def say(self, text: str) -> None:
        """Print a line above the bar."""
        self._bar.write(text, file=sys.stderr)

    def close(self) -> None:
        """Leave the bar as it stands."""
        self._bar.close()
