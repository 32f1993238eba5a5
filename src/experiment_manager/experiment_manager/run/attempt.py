"""How a run directory is to be taken up: where it stands, and what is to be cleared away first."""

import shutil
from pathlib import Path

from experiment_manager.bag.reader import Bag
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
        shutil.rmtree(directory / "bag", ignore_errors=True)
    return resume


def holds_observations(bag: Path) -> bool:
    """Return whether a bag, which may be cut off, holds anything of an episode."""
    try:
        opened = Bag(bag)
        return opened.has("episode") and len(opened.stamps_ns("episode")) > 0
    except InputError:
        # Cut off before anything could be read; what is larger is somebody's to repair.
        return any(file.stat().st_size > _HEADER_BYTES for file in bag.glob("*.mcap"))
