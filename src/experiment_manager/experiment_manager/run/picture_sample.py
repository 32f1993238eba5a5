"""Which episodes' pictures and features are recorded. No ROS."""

from experiment_manager.config import ExperimentManagerConfig
from eye_plant import Episode
from lockstep.wire.topics import TRAINING


def takes_pictures(config: ExperimentManagerConfig, episode: Episode) -> bool:
    """Return whether pictures and features of an episode belong to the recorded sample."""
    number = episode.episode if episode.phase == TRAINING else episode.trial
    return is_sampled(config, episode.phase, number)


def is_sampled(config: ExperimentManagerConfig, phase: int, number: int) -> bool:
    """Return whether the training episode or trial of a number belongs to the sample."""
    in_training = phase == TRAINING
    every = config.pictures_every_n_episodes if in_training else config.pictures_every_n_trials
    return every > 0 and number % every == 0
