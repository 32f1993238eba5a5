"""The pictures on the plane: generated ones, or a directory of the user's own.

The set has a seed of its own, independent of the run's. Training and test pictures are disjoint.
Everywhere a stimulus is counted through: training pictures first, then test pictures.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from eye_plant.stimuli.cache import load_generated, n_missing
from eye_plant.stimuli.directory import choose_files, choose_test_files
from eye_plant.stimuli.picture_file import read_each, read_picture
from eye_plant.stimuli.stereograms import Stereogram
from lockstep import check_settings, setting

SMALLEST_PX = 64


@dataclass(frozen=True)
class StimuliConfig:
    """Which pictures to show; K17 has 100 for training and 40 for tests, of 1920 x 1920 pixels."""

    directory: str = setting(
        "",
        "directory of images that replace the generated ones, with train and test inside, or all"
        " in one, split by seed; empty: none",
    )
    seed: int = setting(0, "seed of the generated stimuli, or of the split of a directory")
    n_training: int = setting(100, "number of training stimuli", least=1)
    n_test: int = setting(40, "number of test stimuli", least=1)
    size_px: int = setting(1920, "width and height of each stimulus", "px", least=SMALLEST_PX)
    cache_directory: str = setting(
        "", "directory of the generated stimuli; empty: the user's cache directory"
    )

    def __post_init__(self) -> None:
        """Refuse values out of range."""
        check_settings(self)


@dataclass(frozen=True)
class StimulusSet:
    """Grey pictures (size, size) uint8, row 0 on top; and pairs of them. All are read only.

    generated: what they were generated from, None for others.
    """

    training: tuple[np.ndarray, ...]
    test: tuple[np.ndarray, ...]
    stereograms: tuple[Stereogram, ...] = ()
    generated: StimuliConfig | None = None

    def __deepcopy__(self, memo: object) -> "StimulusSet":
        """Share what nobody changes; files are mapped once."""
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle generated pictures as how to load them: they are half a gigabyte."""
        if self.generated is not None:
            return load_stimuli, (self.generated,)
        return StimulusSet, (self.training, self.test, self.stereograms)

    @property
    def all(self) -> tuple[np.ndarray, ...]:
        """The grey pictures in the order in which stimuli are counted: training, then test.

        Stereograms are counted after them.
        """
        return self.training + self.test

    @property
    def n_pictures(self) -> int:
        """Pictures and stereograms."""
        return len(self.all) + len(self.stereograms)


def load_stimuli(config: StimuliConfig) -> StimulusSet:
    """Return the set, generated (and kept for the next time) or read from the directory.

    Raises InputError naming the directory that is missing or empty, or all files that cannot be
    used.
    """
    if not config.directory:
        training, test = (load_generated(*arguments) for arguments in _generated(config))
        return StimulusSet(training, test, generated=config)
    training_files, test_files = _choose(config)
    pictures = _read(training_files + test_files, config)
    return StimulusSet(pictures[: len(training_files)], pictures[len(training_files) :])


def announcement(config: StimuliConfig) -> str:
    """Return what load_stimuli will take long with, "" if the cache has all pictures."""
    if config.directory:
        return ""
    n = sum(n_missing(*arguments) for arguments in _generated(config))
    return f"generating {n:,} stimuli, once (on two cores 140 take about a minute)" if n else ""


def load_unseen_stimuli(
    directory: str, config: StimuliConfig, n_most: int
) -> tuple[np.ndarray, ...]:
    """Return up to n_most pictures to test with, of another directory than was trained on.

    Its subdirectory test if it has one, else all its pictures; in an order of config.seed, and of
    config.size_px. Raises InputError naming the directory or file that cannot be used.
    """
    return _read(choose_test_files(directory, config.seed)[:n_most], config)


def count_stimuli(config: StimuliConfig) -> tuple[int, int]:
    """Return the numbers of training and test pictures that load_stimuli would return.

    Reads no picture. Raises InputError naming a directory that is missing or too empty.
    """
    if not config.directory:
        return config.n_training, config.n_test
    training, test = _choose(config)
    return len(training), len(test)


def _choose(config: StimuliConfig) -> tuple[tuple[Path, ...], tuple[Path, ...]]:
    return choose_files(config.directory, config.seed, config.n_training, config.n_test)


def _read(files: Sequence[Path], config: StimuliConfig) -> tuple[np.ndarray, ...]:
    read = partial(read_picture, size_px=config.size_px, smallest_px=SMALLEST_PX)
    return tuple(read_each(read, files))


def _generated(config: StimuliConfig) -> list[tuple[str, int, str, int, int]]:
    """Return the arguments of load_generated for the training pictures and for the test ones."""
    return [
        (config.cache_directory, config.seed, role, n, config.size_px)
        for role, n in (("training", config.n_training), ("test", config.n_test))
    ]
