"""Randomness as a function of (seed, role, number), never of a history.

A resumed run, a restarted node and the in-process loop draw the same numbers, and no generator
state is ever saved.
"""

import hashlib
from dataclasses import dataclass

import numpy as np

# 2**64 blocks of the counter belong to one number, far more than any draw takes.
_NUMBER_WORD = 1


def generator(seed: int, role: str, number: int) -> np.random.Generator:
    """Return the counter-based generator of one draw.

    Philox-4x64 (Salmon et al. 2011) is keyed by the 128-bit BLAKE2b hash of (seed, role), and its
    counter starts at number * 2**64, so that streams of different numbers never overlap.

    seed: any integer; role: what is drawn, such as "episode"; number >= 0: which one.
    Raises ValueError for a negative number.
    """
    if number < 0:
        raise ValueError(f"number: expected 0 or more, got {number}")
    digest = hashlib.blake2b(f"{seed}/{role}".encode(), digest_size=16).digest()
    key = np.frombuffer(digest, dtype="<u8")
    counter = np.zeros(4, dtype=np.uint64)
    counter[_NUMBER_WORD] = number
    return np.random.Generator(np.random.Philox(key=key, counter=counter))


@dataclass(frozen=True)
class Moment:
    """Which observation of a run it is, whatever tests the run makes besides.

    trial: of a test, -1 in training; iteration: within the episode; training_iteration: training
    iterations before it.
    """

    trial: int = -1
    iteration: int = 0
    training_iteration: int = 0

    def generator(self, seed: int, role: str) -> np.random.Generator:
        """Return the generator of what is drawn for this observation alone."""
        return generator(
            seed, f"{role}, trial {self.trial}, {self.iteration}", self.training_iteration
        )
