"""How a run directory is to be taken up: where it stands, and what is to be cleared away first."""

import contextlib
from pathlib import Path

from experiment_manager.bag.metadata import RUN_METADATA
from experiment_manager.bag.reader import Bag
from experiment_manager.bag.writer import remove_bag
from experiment_manager.run import checkpoint
from lockstep import InputError

# A bag's file before its first message: schemas, and the configuration.
_HEADER_BYTES = 1 << 16


def place_of(directory: Path) -> int:
    """Return how many episodes the newest checkpoint of a run holds, -1 without one."""
    found = checkpoint.newest(directory / "checkpoints")
    return found[0].place if found else -1


def goes_on(directory: Path) -> bool:
    """Return whether a run is to go on from a checkpoint.

    Without one, the bag of an attempt that ended before its first episode is removed.
    """
    resume = place_of(directory) >= 0
    if not resume and not holds_observations(directory / "bag"):
        remove_bag(directory / "bag")
    return resume


def holds_observations(bag: Path) -> bool:
    """Return whether a bag, which may be cut off, holds anything of an episode."""
    with contextlib.suppress(InputError):
        opened = Bag(bag)
        if RUN_METADATA in opened.metadata:
            return opened.has("episode") and len(opened.stamps_ns("episode")) > 0
    # Cut off before anything could be read, or not ours: what is larger is somebody's.
    return any(file.stat().st_size > _HEADER_BYTES for file in bag.glob("*.mcap"))
