"""What frozen learners are shown."""

import dataclasses
from dataclasses import dataclass
from pathlib import Path

from eye_plant import StimulusSet, load_stimuli
from eye_plant.stimuli.stereograms import random_dot_stereograms, read_stereograms
from eye_plant.stimuli.stimulus_set import SMALLEST_PX, StimuliConfig, load_unseen_stimuli
from lockstep import InputError


@dataclass(frozen=True)
class Shown:
    """Pictures or stereograms, at most one kind.

    stimuli: a directory of pictures; stereograms: a directory of pairs; random_dots: random-dot
    stereograms, nothing else; generated: the generated test stimuli, for a run that was trained on
    others; without any of them the run's own test stimuli. n_most: so many at most, None is as many
    as who shows them has by default.
    """

    stimuli: Path | None = None
    stereograms: Path | None = None
    random_dots: bool = False
    generated: bool = False
    n_most: int | None = None

    @property
    def text(self) -> str:
        """What is shown, in words; "" for the run's own test stimuli."""
        if self.random_dots:
            return "random-dot stereograms"
        if self.generated:
            return "the generated test stimuli"
        directory = self.stimuli or self.stereograms
        return str(directory.resolve()) if directory else ""

    def load(self, config: StimuliConfig, n_default: int) -> StimulusSet:
        """Return the stimuli, as test stimuli without any for training.

        config: of the run's own; n_default: how many where n_most is None. Raises InputError for
        what cannot be shown.
        """
        directories = (self.stimuli is not None, self.stereograms is not None)
        if sum((*directories, self.random_dots, self.generated)) > 1:
            raise InputError(
                "expected one of a directory, stereograms, random dots and generated stimuli, "
                "got more"
            )
        n_most = n_default if self.n_most is None else self.n_most
        if n_most < 1:
            raise InputError(f"test stimuli: expected 1 or more, got {n_most}")
        if self.random_dots:
            dots = random_dot_stereograms(config.seed, n_most, config.size_px)
            return StimulusSet((), (), dots)
        if self.stereograms is not None:
            directory = str(self.stereograms)
            pairs = read_stereograms(directory, config.seed, n_most, config.size_px, SMALLEST_PX)
            return StimulusSet((), (), pairs)
        if self.generated:
            config = dataclasses.replace(config, directory="")
        if self.stimuli is None:
            if not config.directory:
                # Each is generated from its number: no others are needed.
                few = min(n_most, config.n_test)
                config = dataclasses.replace(config, n_training=1, n_test=few)
            return StimulusSet((), load_stimuli(config).test[:n_most])
        return StimulusSet((), load_unseen_stimuli(str(self.stimuli), config, n_most))


OWN_TEST_STIMULI = Shown()
