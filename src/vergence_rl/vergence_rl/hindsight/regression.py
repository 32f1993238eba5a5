"""Hindsight regression (D12): from each place of an episode to the best one that it visited.

Once an episode is over, the place with the largest reward is known, and with it the change of
activations that would have led there at once from each of the others. The actor A(s) = W s is the
regression of these targets on the states (ours: regression of actions weighted by reward, Peters &
Schaal 2007; learning from one's own best, Oh et al. 2018; relabelling what was reached as what was
wanted, Andrychowicz et al. 2017). Places are compared within an episode, so no critic is needed.

Dimensions: n_visits (iterations of an episode), n_state, n_muscles.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass
class Sums:
    """Sums over visits, each with its weight w; s: (n_state,) state, T: (n_muscles,) target.

    weight: sum w; squares: sum w s s^T, (n_state, n_state); products: sum w s T^T, (n_state,
    n_muscles); targets: sum w T T^T, (n_muscles, n_muscles).
    """

    weight: float
    squares: Floats
    products: Floats
    targets: Floats

    def __post_init__(self) -> None:
        """Keep room for an episode's squares: asking for it each time costs more than using it."""
        self._added = np.empty_like(self.squares)

    def add(self, states: Floats, targets: Floats, weights: Floats, *, kept: float) -> None:
        """Keep so much of what is there, and add an episode's visits.

        states: (n_visits, n_state); targets: (n_visits, n_muscles); weights: (n_visits,).
        """
        root = np.sqrt(weights)[:, None]
        s, t = root * states, root * targets
        self.weight = kept * self.weight + float(weights.sum())
        # A product of an array with its own transpose is symmetric to the last bit.
        np.matmul(s.T, s, out=self._added)
        self.squares *= kept
        self.squares += self._added
        self.products = kept * self.products + s.T @ t
        self.targets = kept * self.targets + t.T @ t


def first_sums(n_state: int, covariance: Floats, weight: float) -> Sums:
    """Return the sums of visits that say nothing but how far targets scatter, of that weight.

    covariance: (n_muscles, n_muscles).
    """
    return Sums(
        weight,
        np.zeros((n_state, n_state)),
        np.zeros((n_state, len(covariance))),
        weight * covariance,
    )


def nearness(targets: Floats, scale: float) -> Floats:
    """Return the weights scale^2 / (scale^2 + |T|^2), (n_visits,), in (0, 1].

    targets: (n_visits, n_muscles). ours: a target is met the less exactly the farther away it is;
    the weight falls as the influence of an error does with a Cauchy loss.
    """
    squared: Floats = (targets**2).sum(axis=1)
    return scale**2 / (scale**2 + squared)


def weights_of_ranks(n_best: int) -> Floats:
    """Return the weights, (n_best,), of an episode's best places in its target, the best one first.

    In proportion to ln(n_best + 1/2) - ln(rank), rank 1 for the best; they add up to 1 (Hansen &
    Ostermeier 2001). Ranks weigh alike whether rewards differ by much, early in training, or
    hardly.
    """
    weights = np.log(n_best + 0.5) - np.log(np.arange(1, n_best + 1))
    return np.asarray(weights / weights.sum(), dtype=np.float64)


def regressed_actor(sums: Sums, ridge_shares: Floats) -> Floats:
    """Return W (n_muscles, n_state), the least of sum w |T - W s|^2 + sum_k ridge_k |W_k|^2.

    ridge_k = ridge_shares[k], (n_state,), of the weights of entry k, times the mean of the diagonal
    of sum w s s^T, so that it has the states' scale and grows with what is remembered. The ten
    states of an episode share one target: without a ridge its noise is learned (ridge regression:
    Hoerl & Kennard 1970).
    """
    n_state = len(sums.squares)
    ridges = ridge_shares * np.trace(sums.squares) / n_state
    if not ridges.any():
        return np.zeros(sums.products.T.shape)
    weights = np.linalg.solve(sums.squares + np.diag(ridges), sums.products)
    return np.ascontiguousarray(weights.T)


def residual_covariance(sums: Sums, weights: Floats) -> Floats:
    """Return sum w (T - W s)(T - W s)^T / sum w, (n_muscles, n_muscles), for an actor W.

    What the actor cannot tell of the targets is what is worth trying out: the covariance of the
    exploration (D16; the M-step of Peters & Schaal 2007).
    """
    explained = weights @ sums.products
    scatter = sums.targets - explained - explained.T + weights @ sums.squares @ weights.T
    covariance: Floats = scatter / sums.weight
    return (covariance + covariance.T) / 2.0
