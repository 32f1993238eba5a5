"""Gaze targets of an episode: one place to look at after the other."""

import numpy as np

from experiment_manager.experiment.config import ProtocolConfig

_MOST_DRAWS = 1000


def drawn_targets_deg(
    config: ProtocolConfig,
    n_iterations: int,
    gaze_deg: tuple[float, float],
    draw: np.random.Generator,
) -> tuple[float, ...]:
    """Draw azimuth and elevation of the target of each fixation, one after the other.

    gaze_deg: those of the left eye at the start. Each target lies at a drawn distance from the one
    before, in a direction that is drawn until it is within range; a gaze so far aside that none is
    comes back to the nearest place within range.
    """
    targets_deg: list[float] = []
    least_deg, most_deg = config.target_distance_deg
    place, most = np.array(gaze_deg), np.array(config.largest_target_deg)
    for _ in range(n_iterations // config.fixation_iterations):
        for _ in range(_MOST_DRAWS):
            away = draw.uniform(least_deg, most_deg)
            direction = draw.uniform(0.0, 2.0 * np.pi)
            target = place + away * np.array([np.cos(direction), np.sin(direction)])
            if (np.abs(target) <= most).all():
                break
        place = np.clip(target, -most, most)
        targets_deg += place.tolist()
    return tuple(targets_deg)
