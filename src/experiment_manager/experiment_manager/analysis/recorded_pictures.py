"""Which episodes of a bag have pictures of both eyes."""

from dataclasses import dataclass

import numpy as np

from experiment_manager.bag.reader import Bag, VectorTable
from lockstep.errors import InputError
from lockstep.wire.topics import PICTURES


@dataclass(frozen=True)
class PicturedEpisodes:
    """truth: all of the bag's ground truth; rows: those of each episode, by time."""

    truth: VectorTable
    rows: tuple[np.ndarray, ...]


def pictured_episodes(bag: Bag) -> PicturedEpisodes:
    """Return the episodes with a pair of pictures; InputError when there is none."""
    truth = bag.vectors("ground_truth")["ground_truth"]
    number = np.cumsum(truth.column("iteration") == 0)
    left, right = (set(bag.stamps_ns(t).tolist() if bag.has(t) else ()) for t in PICTURES)
    both = np.array(sorted(left & right), np.int64)
    wanted = np.unique(number[np.isin(truth.stamps_ns, both)])
    if not len(wanted):
        raise InputError(f"bag {bag.path}: expected pictures of both eyes, it has none")
    return PicturedEpisodes(truth, tuple(np.flatnonzero(number == n) for n in wanted))
