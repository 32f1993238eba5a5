"""The sparse coder: two pictures in, features and reconstruction errors out, dictionaries inside.

Dimensions: n_scales, by default 2, coarse before fine; n_patches, n_pixels, n_bases, n_selections.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lockstep import InputError, generator
from lockstep.randomness import Moment
from sparse_coder.config import SparseCoderConfig
from sparse_coder.dictionary import (
    Dictionary,
    dictionary_rate,
    initial_atoms,
    learned_atoms,
    learned_means,
    plasticity,
)
from sparse_coder.gaze.fixations import gaze_watch
from sparse_coder.matching_pursuit import (
    Selections,
    matching_pursuit,
    mean_squared_coefficients,
    residuals_of_eyes,
)
from sparse_coder.patches import (
    N_PIXELS,
    Image,
    check_images,
    patches_and_energies,
    sees_with_both,
)
from sparse_coder.percept import NOT_GIVEN_DEG, Encoding, Percept
from sparse_coder.picture_of_code import coded_patches
from sparse_coder.reward import (
    information,
    lambda_by_now,
    random_reward,
    reconstruction_error,
    reward,
)
from sparse_coder.suppression import gains, learned_dominance, with_gains
from sparse_coder.windows import windows_of

_LARGEST_NORM_ERROR = 1e-4
_START = Moment()


class SparseCoder:
    """Owns one dictionary per scale.

    perceive and learn are separate, so that features and reward can be published before the
    dictionaries move; whatever of the work needs the atoms alone is done in learn.

    Example:
        >>> import numpy as np
        >>> from sparse_coder import SparseCoder, SparseCoderConfig
        >>> left, right = np.random.default_rng(0).integers(0, 256, (2, 240, 320), np.uint8)
        >>> coder = SparseCoder(SparseCoderConfig(n_bases=40))
        >>> percept = coder.perceive(left, right, metabolic_rates_w=np.zeros(4))
        >>> percept.encoding.features.shape
        (2, 40)
        >>> coder.learn(percept.encoding)
    """

    def __init__(self, config: SparseCoderConfig) -> None:
        """Start with random dictionaries, a function of the seed."""
        self.config = config
        self.learning_steps = 0
        self._dictionaries = [
            Dictionary(
                initial_atoms(generator(config.seed, "dictionary", i), config.n_bases, N_PIXELS)
            )
            for i, _ in enumerate(config.scales.all)
        ]
        # Of each patch: how far the left eye suppresses the right one, from -1 to 1.
        self.dominances = [np.zeros(scale.n_patches) for scale in config.scales.all]
        # Of E, fast and slow: before the first image nothing is explained.
        self._means = np.array([0.0, len(config.scales.all)])
        self._watch = gaze_watch(config)

    def perceive(
        self,
        left: Image,
        right: Image,
        metabolic_rates_w: NDArray[np.float64],
        *,
        apart: Sequence[NDArray[np.uint8]] = (),
        moment: Moment = _START,
        given_deg: NDArray[np.float64] = NOT_GIVEN_DEG,
    ) -> Percept:
        """Return what an observation is worth, and what it says of gaze; the atoms stay.

        left, right: grey uint8 pictures (height_px, width_px).
        apart: as for `encode`.
        metabolic_rates_w: (n_muscles,) settled rates of the charged muscles, (0,) of joints.
        moment: which observation it is; turns of the eyes are followed from iteration 0 on.
        given_deg: (2, 2) place to look at when a fixation begins, in the left and in the right
        picture, NaN where the eyes choose.

        Raises InputError for unsuitable pictures or rates.
        """
        encoding = self.encode(left, right, apart)
        rate_w = float(metabolic_rates_w.sum())
        verges = moment.iteration < self.config.n_verging
        worth = encoding.worth_to_eyes if verges else encoding.worth_to_lenses
        earned = reward(worth, rate_w, self.lambda_by_now)
        if not len(metabolic_rates_w):
            rate_w = math.nan
        if self.config.random_reward:
            earned = random_reward(self.config.seed, self.learning_steps, moment.iteration)
        watch = self._watch
        gaze = None
        if watch:
            gaze = watch.step(moment, (left, right), encoding, given_deg)
        return Percept(
            encoding, rate_w, earned.energy_penalty, earned.value, self.learning_steps, gaze
        )

    def encode(
        self, left: Image, right: Image, apart: Sequence[NDArray[np.uint8]] = ()
    ) -> Encoding:
        """Return the code of two grey uint8 pictures (height, width); changes nothing.

        apart: of each scale with a picture of its own both eyes' (2, height, width).
        Raises InputError for pictures of another type or number, of odd or different or too small
        size.
        """
        config = self.config
        patches, energies = self.patches(left, right, apart)
        selections = tuple(
            matching_pursuit(p, d.atoms, d.gram, config.n_selections)
            for p, d in zip(patches, self._dictionaries, strict=True)
        )
        features = np.stack([mean_squared_coefficients(s, config.n_bases) for s in selections])
        n_for_eyes = config.scales.n_for_eyes
        # What one image has says nothing of disparity.
        if config.n_lenses and not sees_with_both(energies[:n_for_eyes]):
            features[:n_for_eyes] = 0.0
        errors = [reconstruction_error(p, s) for p, s in zip(patches, selections, strict=True)]
        told = self._information(patches, energies, selections)
        code = features, np.array(errors), patches, selections, told, energies
        return Encoding(*code, dominance=self.dominances[-1])

    def patches(
        self, left: Image, right: Image, apart: Sequence[NDArray[np.uint8]] = ()
    ) -> tuple[tuple[NDArray[np.float32], ...], tuple[NDArray[np.float64], ...]]:
        """Return the patches that `encode` codes, and each eye's energies in them before gains."""
        scales = self.config.scales
        check_images(left, right, scales.widest_px)
        pairs = windows_of(left, right, apart, scales)
        patches, energies = zip(*(patches_and_energies(*pair) for pair in pairs), strict=True)
        if self.config.suppression_iterations:
            patches = tuple(map(with_gains, patches, self.dominances))
        return patches, energies

    def _information(
        self,
        patches: Sequence[NDArray[np.float32]],
        energies: Sequence[NDArray[np.float64]],
        selections: Sequence[Selections],
    ) -> NDArray[np.float64]:
        """Return I of each scale for lenses, of its patches and their energies."""
        told, first = [], self.config.scales.n_for_eyes
        for i, noise in enumerate(self.config.noise_energies, first):
            left = residuals_of_eyes(patches[i], self._dictionaries[i].atoms, selections[i])
            whole = energies[i]
            if self.config.suppression_iterations:
                powers = gains(self.dominances[i]) ** 2
                whole, left = powers * whole, left / powers
            told.append(information(whole, left, noise))
        return np.array(told)

    def learn(self, encoding: Encoding) -> None:
        """Move all dictionaries by one step towards the pictures that they encoded.

        A rate of 0 leaves the dictionaries unchanged (D17).
        """
        rate = self._learning_rate()
        self.learning_steps += 1
        self._learn_what_counts(encoding)
        if rate == 0.0:
            return
        for dictionary, patches, selections in zip(
            self._dictionaries, encoding.patches, encoding.selections, strict=True
        ):
            dictionary.replace(learned_atoms(dictionary.atoms, patches, selections, rate))

    def _learn_what_counts(self, encoding: Encoding) -> None:
        """Move both means of E, and the dominance of each eye, where these are followed."""
        config = self.config
        if config.plasticity_iterations:
            error = float(np.sum(encoding.reconstruction_error))
            self._means = learned_means(self._means, error, config.plasticity_iterations)
        if config.suppression_iterations:
            atoms = [dictionary.atoms for dictionary in self._dictionaries]
            coded = map(coded_patches, encoding.selections, atoms)
            of_scales = zip(
                self.dominances, encoding.patches, coded, encoding.energies, strict=True
            )
            n = config.suppression_iterations
            self.dominances = [learned_dominance(*of_scale, n) for of_scale in of_scales]

    def _learning_rate(self) -> float:
        config = self.config
        if config.plasticity_iterations:
            return config.learning_rate * plasticity(self._means)
        done = min(1.0, self.learning_steps / config.n_until_rest)
        return dictionary_rate(config.learning_rate, config.final_learning_rate_share, done)

    @property
    def lambda_by_now(self) -> float:
        """Lambda by now, in 1/W (D21)."""
        n_rising = self.config.price_rise_share * self.config.n_training_iterations
        return lambda_by_now(self.config.metabolic_cost_weight, self.learning_steps, n_rising)

    def atoms(self) -> NDArray[np.float32]:
        """Return a copy of the basis functions, (n_scales, n_bases, n_pixels)."""
        return np.stack([dictionary.atoms for dictionary in self._dictionaries])

    def state(self) -> dict[str, NDArray[Any]]:
        """Return all that learning has changed, for restore, as copies."""
        state = {"atoms": self.atoms(), "learning_steps": np.array(self.learning_steps)}
        return state | self._what_counts()

    def _what_counts(self) -> dict[str, NDArray[np.float64]]:
        """Return the means of E, and dominances of all scales' patches, where they are followed."""
        followed = {}
        if self.config.plasticity_iterations:
            followed["means_of_error"] = self._means.copy()
        if self.config.suppression_iterations:
            followed["dominances"] = np.concatenate(self.dominances)
        return followed

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Continue from what state returned, bit for bit.

        Raises InputError, and changes nothing, unless it holds finite unit atoms of this
        configuration's shape and a count of learning steps.
        """
        followed = self._what_counts()
        expected = {"atoms", "learning_steps", *followed}
        if set(state) != expected:
            raise InputError(f"state: expected {sorted(expected)}, got {sorted(state)}")
        for name, own in followed.items():
            _check_like(name, state[name], own)
        atoms = _checked_atoms(state["atoms"], len(self.config.scales.all), self.config.n_bases)
        learning_steps = _checked_count(state["learning_steps"])
        self._dictionaries = [Dictionary(a.copy()) for a in atoms]
        self.learning_steps = learning_steps
        self._means = state.get("means_of_error", self._means).copy()
        if "dominances" in followed:
            ends = np.cumsum([len(of_scale) for of_scale in self.dominances])[:-1]
            self.dominances = [d.copy() for d in np.split(state["dominances"], ends)]


def _check_like(name: str, array: NDArray[Any], own: NDArray[np.float64]) -> None:
    if array.shape != own.shape or array.dtype != own.dtype or not np.isfinite(array).all():
        raise InputError(
            f"{name}: expected finite float64 of shape {own.shape}, got {array.dtype} of shape "
            f"{array.shape}"
        )


def _checked_atoms(atoms: NDArray[Any], n_scales: int, n_bases: int) -> NDArray[np.float32]:
    shape = (n_scales, n_bases, N_PIXELS)
    if atoms.shape != shape or atoms.dtype != np.float32:
        raise InputError(
            f"atoms: expected float32 of shape {shape}, got {atoms.dtype} of shape {atoms.shape}"
        )
    error = np.abs(np.linalg.norm(atoms.astype(np.float64), axis=2) - 1.0).max()
    if not error <= _LARGEST_NORM_ERROR:  # also true of NaN
        raise InputError(f"atoms: expected unit norms, got one off by {error}")
    return atoms


def _checked_count(learning_steps: NDArray[Any]) -> int:
    if learning_steps.shape != () or learning_steps.dtype.kind not in "iu" or learning_steps < 0:
        raise InputError(f"learning_steps: expected one count, got {learning_steps!r}")
    return int(learning_steps)
