"""What the senses make of what is there: noise of pictures and of felt activations, and gaps.

Noise is a function of the seed and of the moment, so nothing of it is saved. A picture or an
activation that is missing stays as it was last, as a camera repeats a lost frame.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from eye_plant.camera.config import CameraConfig
from lockstep import SIDES, setting
from lockstep.optics import TurnNoiseConfig, share
from lockstep.randomness import Moment

_N = 2**16


@dataclass(frozen=True)
class NoiseConfig(TurnNoiseConfig):
    """Noise of all that is measured; raises InputError for a value out of range."""

    picture_sd: float = setting(
        0.0,
        "standard deviation of the noise of each pixel, independent in both eyes and at all times",
        "grey levels",
        least=0,
        most=255,
    )
    missing_pictures: float = share("images of an eye that are missing; its last one stays")
    activation_sd: float = setting(
        0.0,
        "standard deviation of the noise of each activation that the agent gets",
        least=0,
        most=1,
    )
    missing_activations: float = share(
        "activations that the agent does not get; their last values stay"
    )

    @property
    def is_of_activations(self) -> bool:
        """Whether activations are felt other than they are."""
        return self.activation_sd > 0.0 or self.missing_activations > 0.0


class Senses:
    """Measures one observation of an episode after another.

    seed: of the noise; it may be set between two episodes.
    """

    def __init__(self, noise: NoiseConfig, camera: CameraConfig, seed: int) -> None:
        """Have measured nothing."""
        self._noise, self.seed = noise, seed
        self._picture_px = camera.height_px, camera.width_px
        self.begin()

    def begin(self) -> None:
        """Forget the last episode: nothing is missing in the first observation of one."""
        # By what they are drawn for.
        self._last_pictures: dict[str, NDArray[np.uint8]] = {}
        self._last_felt: NDArray[np.float64] | None = None

    def pictures(
        self, drawn: NDArray[np.uint8], moment: Moment, scale: str = ""
    ) -> NDArray[np.uint8]:
        """Return both eyes' pictures (2, roi_height_px, roi_width_px) as the cameras give them.

        A pixel's noise does not depend on the region of interest. scale: of which these are a
        picture of its own.
        """
        noise = self._noise
        if not noise.picture_sd and not noise.missing_pictures:
            return drawn
        draw = moment.generator(self.seed, f"pictures {scale}" if scale else "pictures")
        seen = drawn
        if noise.picture_sd:
            size_px = drawn.shape[1:] if scale else self._picture_px
            noisy = drawn + _central(self._grey_levels(draw, size_px), drawn.shape[1:])
            seen = np.clip(noisy, 0, 255).astype(np.uint8)
        if scale in self._last_pictures:
            is_missing = draw.random(len(seen)) < noise.missing_pictures
            seen = np.where(is_missing[:, None, None], self._last_pictures[scale], seen)
        self._last_pictures[scale] = seen
        return seen.copy()

    def felt(self, activations: NDArray[np.float64], moment: Moment) -> NDArray[np.float64]:
        """Return activations (n_muscles,) as they are felt, in [0, 1]."""
        noise = self._noise
        if not noise.is_of_activations:
            return activations
        draw = moment.generator(self.seed, "felt activations")
        errors = draw.normal(0.0, noise.activation_sd, activations.shape)
        felt = np.clip(activations + errors, 0.0, 1.0)
        if self._last_felt is not None:
            is_missing = draw.random(activations.shape) < noise.missing_activations
            felt = np.where(is_missing, self._last_felt, felt)
        self._last_felt = felt
        return felt

    def _grey_levels(
        self, draw: np.random.Generator, size_px: tuple[int, ...]
    ) -> NDArray[np.int16]:
        """Return the noise (2, height_px, width_px) of two pictures."""
        size = (len(SIDES), *size_px)
        return _quantiles(self._noise.picture_sd)[draw.integers(_N, size=size, dtype=np.uint16)]


def _central(values: NDArray[np.int16], size: tuple[int, ...]) -> NDArray[np.int16]:
    """Return the centre (2, *size) of values (2, height, width)."""
    top, left = ((whole - kept) // 2 for whole, kept in zip(values.shape[1:], size, strict=True))
    return values[:, top : top + size[0], left : left + size[1]]


@lru_cache(maxsize=4)
def _quantiles(sd: float) -> NDArray[np.int16]:
    """Return the quantiles (_N,) of Gaussian noise, in whole grey levels.

    Drawn by a whole random number, which takes a fifth of the time of a Gaussian one.
    """
    middles = (np.arange(_N) + 0.5) / _N
    return np.rint(sd * ndtri(middles)).astype(np.int16)
