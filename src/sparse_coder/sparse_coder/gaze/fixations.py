"""Where the eyes are to look next, and how they turned: the steps of a fixation.

A fixation begins with a target in the picture of the eye that leads: given, or the place that the
code shows worst. A saccade leads there; how both eyes turned is measured in their pictures, and a
second saccade is to make up for what the first one missed. The left eye leads unless it sees
nothing, or the right one suppresses it. The following iterations are left to vergence: how the
first of its commands, the third and so on turned the eyes is measured, too. Without saccades there
is no target, and two turns of an episode are measured (D23).
"""

import math

import numpy as np
from numpy.typing import NDArray

from lockstep.optics import TurnNoiseConfig
from lockstep.randomness import Moment
from lockstep.scales import STRIDE_PX
from lockstep.wire.topics import N_SACCADES
from sparse_coder.config import SparseCoderConfig
from sparse_coder.gaze.movement import movement, rotation, swing_deg
from sparse_coder.matching_pursuit import residual_energies
from sparse_coder.patches import COARSE
from sparse_coder.percept import NOWHERE_DEG, UNSEEN_DEG, Encoding, Gaze

Floats = NDArray[np.float64]
Pictures = tuple[NDArray[np.uint8], NDArray[np.uint8]]

_AHEAD = np.array([0.0, 0.0, 1.0])
# Of vergence's commands the first turns the eyes most; the later ones lower the metabolic rate
# (D23) at activations that no first command reaches.
_MEASURED_EVERY = 2
# Without saccades: the first command, and one when the eyes have verged and their muscles have
# relaxed.
_MEASURED = (1, 6)
NO_NOISE = TurnNoiseConfig()
# The scale at which the next place is chosen, and how far looking at a place inhibits return to it.
_COARSE = 0
_INHIBITION_DEG = 3.0
# So that eyes that hardly suppress one another do not change the lead.
_LEAST_DOMINANCE = 0.1


class Turns:
    """Measures the turns of one episode after another, without saccades (D23)."""

    def __init__(
        self, focal_length_px: float, noise: TurnNoiseConfig = NO_NOISE, seed: int = 0
    ) -> None:
        """focal_length_px: of both cameras, whose magnification an eye does not know."""
        self._focal_length_px = focal_length_px
        self._noise, self._seed = noise, seed
        self._before: Pictures | None = None

    def step(
        self, moment: Moment, pictures: Pictures, encoding: Encoding, given_deg: Floats
    ) -> Gaze:
        """Return what an observation says of gaze: turns, and never a target."""
        iteration = moment.iteration
        turns_deg = self._turns_deg(pictures, moment) if iteration in _MEASURED else UNSEEN_DEG
        self._before = _kept(pictures) if iteration + 1 in _MEASURED else None
        return Gaze(NOWHERE_DEG, turns_deg)

    def _turns_deg(self, pictures: Pictures, moment: Moment) -> Floats:
        """Return how each eye turned since the pictures that were kept, (2, 3) as Gaze has them."""
        if self._before is None:
            return UNSEEN_DEG
        pairs = zip(self._before, pictures, strict=True)
        turns_deg = np.array([movement(*pair, self._focal_length_px) for pair in pairs])
        return with_noise(turns_deg, self._noise, self._seed, moment)


class Fixations(Turns):
    """Follows the fixations of one episode after another."""

    def __init__(
        self,
        n_iterations: int,
        focal_length_px: float,
        noise: TurnNoiseConfig = NO_NOISE,
        seed: int = 0,
        px_per_pixel: float = COARSE.px_per_pixel,
    ) -> None:
        """n_iterations: of a fixation; px_per_pixel: of the first scale; others: as for Turns."""
        super().__init__(focal_length_px, noise, seed)
        self._px_per_pixel = px_per_pixel
        self._n_iterations = n_iterations
        self._ahead = _AHEAD
        self._leads = 0
        # Directions (3,) of the places looked at in this episode, in the leading eye's camera now.
        self._visited: list[Floats] = []

    def step(
        self, moment: Moment, pictures: Pictures, encoding: Encoding, given_deg: Floats
    ) -> Gaze:
        """Return what an observation says of gaze.

        given_deg: (2, 2) the target that a fixation begins with, in either picture, NaN where the
        eyes choose.
        """
        iteration = moment.iteration
        if iteration == 0:
            self._visited = []
        of_fixation = iteration % self._n_iterations
        if of_fixation == 0:
            before, self._leads = self._leads, _leading_eye(pictures, encoding)
            if self._leads != before:
                self._visited = []  # by the other eye
            self._visited.append(_AHEAD)
            target_deg = given_deg[self._leads]
            if not np.isfinite(target_deg).all():
                target_deg = self._worst_deg(encoding)
            self._before = _kept(pictures)
            self._ahead = rotation(np.append(target_deg, 0.0))[:, 2]
            return Gaze(target_deg, UNSEEN_DEG, self._leads)
        if of_fixation == 1 and self._before is not None:
            return self._corrected(pictures, moment)
        is_measured = (of_fixation - N_SACCADES) % _MEASURED_EVERY == 1
        turns_deg = self._turns_deg(pictures, moment) if is_measured else UNSEEN_DEG
        self._before = None if is_measured else _kept(pictures)
        return Gaze(NOWHERE_DEG, turns_deg, self._leads)

    def _corrected(self, pictures: Pictures, moment: Moment) -> Gaze:
        turns_deg = self._turns_deg(pictures, moment)
        turned_deg = turns_deg[self._leads]
        self._before = None
        if np.isnan(turned_deg).any():
            self._visited = []  # where those places are now is not known
            return Gaze(NOWHERE_DEG, turns_deg, self._leads)
        target_deg = swing_deg(rotation(turned_deg).T @ self._ahead)
        # The second saccade ends at the target.
        turned = rotation(turned_deg) @ rotation(np.append(target_deg, 0.0))
        self._visited = [turned.T @ place for place in self._visited]
        return Gaze(target_deg, turns_deg, self._leads)

    def _worst_deg(self, encoding: Encoding) -> Floats:
        """Return the place (2,) whose code leaves most, apart from those looked at before.

        Up to 1.5 px (0.3 deg) off to the right and down: the pyramid keeps every fourth pixel, from
        the first one on, so that coarse patches lie a little to the left of and above these places.
        """
        patches, selections = encoding.patches[_COARSE], encoding.selections[_COARSE]
        left = residual_energies(patches, selections).astype(np.float64)
        n_columns = math.isqrt(len(patches))
        offsets = (np.arange(n_columns) - (n_columns - 1) / 2.0) * STRIDE_PX * self._px_per_pixel
        right_px, down_px = np.meshgrid(offsets, offsets)
        ahead_px = np.full(right_px.shape, self._focal_length_px)
        places = np.stack([right_px, down_px, ahead_px], axis=2).reshape(-1, 3)
        places /= np.linalg.norm(places, axis=1, keepdims=True)
        for visited in self._visited:
            away_deg = np.degrees(np.arccos(np.clip(places @ visited, -1.0, 1.0)))
            left *= 1.0 - np.exp(-0.5 * (away_deg / _INHIBITION_DEG) ** 2)
        return swing_deg(places[int(left.argmax())])


def gaze_watch(config: SparseCoderConfig) -> Fixations | Turns | None:
    """Return what follows the gaze through episodes, None where turns are not measured."""
    measured = config.camera.focal_length_px, config.noise, config.seed
    if config.fixation_iterations:
        coarse = config.scales.all[_COARSE]
        return Fixations(config.fixation_iterations, *measured, coarse.px_per_pixel)
    return Turns(*measured) if config.measures_turns else None


def _leading_eye(pictures: Pictures, encoding: Encoding) -> int:
    """Return which eye is to look at the target: 0 the left one, 1 the right one."""
    is_blind = [bool(picture.min() == picture.max()) for picture in pictures]
    if is_blind[0] != is_blind[1]:
        return int(is_blind[0])
    return int(encoding.dominance.mean() < -_LEAST_DOMINANCE)


def with_noise(turns_deg: Floats, noise: TurnNoiseConfig, seed: int, moment: Moment) -> Floats:
    """Return turns (2, 3) as they are measured with noise, NaN where one is missing."""
    if noise == NO_NOISE:
        return turns_deg
    draw = moment.generator(seed, "turns")
    errors_deg = draw.normal(0.0, noise.turn_sd_deg, turns_deg.shape)
    is_missing = draw.random(len(turns_deg)) < noise.missing_turns
    return np.where(is_missing[:, None], math.nan, turns_deg + errors_deg)


def _kept(pictures: Pictures) -> Pictures:
    """Return copies: a picture lasts until the next one."""
    left, right = pictures
    return left.copy(), right.copy()
