"""What the sparse coder makes of an observation: code, reward, and where to look.

Dimensions: n_scales, by default 2, coarse before fine; n_patches, n_pixels, n_bases.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sparse_coder.matching_pursuit import Selections


@dataclass(frozen=True)
class Encoding:
    """The sparse code of one pair of pictures.

    features: (n_scales, n_bases) mean squared coefficient of each atom; where there are lenses and
    one eye sees nothing, 0 at the scales for the eyes;
    reconstruction_error: (n_scales,) unexplained share of the patches' energy, in [0, 1];
    patches: per scale (n_patches, n_pixels); selections: per scale;
    information: (n,) what the code tells of the windows of the n scales for lenses, in nats a
    patch; energies: per scale (n_patches, 2) of each eye's half, before it has norm 1;
    dominance: (n_patches,) at the finest scale, how far the left eye suppresses the right one.
    """

    features: NDArray[np.float32]
    reconstruction_error: NDArray[np.float64]
    patches: tuple[NDArray[np.float32], ...]
    selections: tuple[Selections, ...]
    information: NDArray[np.float64]
    energies: tuple[NDArray[np.float64], ...]
    dominance: NDArray[np.float64]

    @property
    def worth_to_eyes(self) -> float:
        """-E, of the scales for the eyes."""
        n_for_eyes = len(self.reconstruction_error) - len(self.information)
        return -float(np.sum(self.reconstruction_error[:n_for_eyes]))

    @property
    def worth_to_lenses(self) -> float:
        """I, of the scales for lenses."""
        return float(np.sum(self.information))


@dataclass(frozen=True)
class Gaze:
    """What turns of the eyes need of an observation (D22, D23).

    target_deg: (2,) sideways and up from the line of sight of the eye that leads, NaN when there is
    no saccade to make; turns_deg: (2, 3) how each eye turned since the observation before, to the
    right, up and clockwise, NaN where that was not measured or is not clear; leading_eye: 0 the
    left one, 1 the right one.
    """

    target_deg: NDArray[np.float64]
    turns_deg: NDArray[np.float64]
    leading_eye: int = 0

    def values(self) -> tuple[float, ...]:
        """Return the values of lockstep.wire.topics.GAZE_NAMES."""
        return (*self.target_deg.tolist(), *self.turns_deg.ravel().tolist(), self.leading_eye)


NOWHERE_DEG, UNSEEN_DEG = np.full(2, np.nan), np.full((2, 3), np.nan)
NOT_GIVEN_DEG = np.full((2, 2), np.nan)
NO_GAZE = Gaze(NOWHERE_DEG, UNSEEN_DEG)


@dataclass(frozen=True)
class Percept:
    """What the coder makes of an observation.

    metabolic_rate_w: C, of the muscles that are charged, NaN of joints; energy_penalty: lambda C;
    reward: -E - lambda C (K17 eq. 5), or I - lambda C; learning_steps: of the coder, before it
    learns from this; gaze: None where nobody asks.
    """

    encoding: Encoding
    metabolic_rate_w: float
    energy_penalty: float
    reward: float
    learning_steps: int
    gaze: Gaze | None = None

    def reward_values(self) -> tuple[float, ...]:
        """Return the values of lockstep.wire.topics.reward_names."""
        return (
            *self.encoding.reconstruction_error.tolist(),
            self.metabolic_rate_w,
            self.energy_penalty,
            self.reward,
            self.learning_steps,
        )
