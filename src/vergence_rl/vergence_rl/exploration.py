"""How far actions are tried out, and how much is learned from one that was."""

from vergence_rl.config import PAPER_EXPLORATION_VARIANCE


def exploration_sd(
    initial_sd: float, wide_share: float, final_share: float, fraction_done: float
) -> float:
    """Return the noise's standard deviation after a fraction of training, in [0, 1] (D16).

    sigma_0 up to wide_share of training, then exponentially down to sigma_0 final_share (K17:
    sigma_0 throughout). ours: only noise wider than the valley of E finds it from afar, and only
    noise narrower than it shows where its ground is.
    """
    done = max(0.0, fraction_done - wide_share) / (1.0 - wide_share)
    return initial_sd * final_share**done


def step_scale(sd: float, exponent: float) -> float:
    """Return (sigma_K17 / sigma)^exponent, by which the actor's step is multiplied (D16; K17: 0).

    The gradient of a Gaussian policy's log-likelihood is (a - A) / sigma^2 (Williams 1992): a
    surplus of any size tells as much. With exponent 1 a step has the same size whatever sigma, with
    0 learning fades as the noise narrows.
    """
    return (PAPER_EXPLORATION_VARIANCE**0.5 / sd) ** exponent if sd > 0.0 else 1.0
