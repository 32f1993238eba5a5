"""What an observation is worth: the one step that the node and every loop in one process share."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sparse_coder.coder import SparseCoder
from sparse_coder.config import SparseCoderConfig
from sparse_coder.encoding import Encoding
from sparse_coder.gaze.fixations import NOWHERE_DEG, Fixations, Gaze, Turns
from sparse_coder.reward import reward


@dataclass(frozen=True)
class Percept:
    """What the coder makes of an observation.

    metabolic_rate_w: C, of the muscles that are charged; learning_steps: of the coder, before it
    learns from this; gaze: None where nobody asks.
    """

    encoding: Encoding
    metabolic_rate_w: float
    reward: float
    learning_steps: int
    gaze: Gaze | None = None

    def reward_values(self) -> tuple[float, ...]:
        """Return the values of lockstep.wire.topics.REWARD_NAMES."""
        errors = self.encoding.reconstruction_error.tolist()
        return (*errors, self.metabolic_rate_w, self.reward, self.learning_steps)


def gaze_watch(config: SparseCoderConfig) -> Fixations | Turns | None:
    """Return what follows the gaze through episodes, None where nobody asks."""
    focal_length_px = config.camera.focal_length_px
    if config.fixation_iterations:
        return Fixations(config.fixation_iterations, focal_length_px)
    return Turns(focal_length_px) if config.measures_turns else None


def perceive(
    coder: SparseCoder,
    left: NDArray[np.uint8],
    right: NDArray[np.uint8],
    metabolic_rates_w: NDArray[np.float64],
    *,
    watch: Fixations | Turns | None = None,
    iteration: int = 0,
    given_deg: NDArray[np.float64] = NOWHERE_DEG,
) -> Percept:
    """Encode both pictures and weigh the code's error against the price of energy.

    left, right: (height_px, width_px); metabolic_rates_w: (n_muscles,) settled rates of the muscles
    that are charged; watch: of the gaze; iteration, given_deg: as its step takes them. Raises
    InputError for pictures and rates that cannot be.
    """
    encoding = coder.encode(left, right)
    metabolic_rate_w = float(metabolic_rates_w.sum())
    reward_t = reward(encoding.reconstruction_error, metabolic_rate_w, coder.metabolic_cost_weight)
    gaze = watch.step(iteration, (left, right), encoding, given_deg) if watch else None
    return Percept(encoding, metabolic_rate_w, reward_t, coder.learning_steps, gaze)
