"""Which recorded episodes a film shows, and what is needed of them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from active_binocular_vision.runs.recorded import (
    PicturedEpisodes,
    evaluation_settings_of,
    pictured_episodes,
)
from experiment_manager import Bag, VectorTable
from eye_plant.mechanics.mujoco_model import MechanicsConfig
from eye_plant.mechanics.muscle_energetics import Musculature
from lockstep import MUSCLE_NAMES, PAIR
from lockstep.wire.topics import EYE_STATE_NAMES, PICTURES, TARGET_NAMES, TEST

SCENES_PER_STAGE = 3
ERRORS = ("vergence", "vertical", "cyclovergence")
# What comes later is rest; of eyes that make saccades two fixations are shown.
_MOST_ITERATIONS, _MOST_FIXATIONS = 10, 5
_LEAST_START_ERROR_DEG = 0.5


@dataclass(frozen=True)
class Scene:
    """The first iterations of an episode, n of them.

    pictures: (n, 2, height, width) uint8; errors_deg: (n, 3) vergence, vertical and cyclovergence
    error, of the pair (n, 1) the first; metabolic_rate_w: (n,) of both eyes; eye_angles_rad:
    (n, 6) adduction, elevation and intorsion, left eye first; activations: (n, 12) of all muscles;
    mechanics: whose eyes; px_deg: visual angle of a pixel; targets_deg: (n, 2) gaze target, to the
    right and up of the left picture's centre, None where none is given.
    """

    caption: str
    pictures: np.ndarray
    errors_deg: np.ndarray
    metabolic_rate_w: np.ndarray
    eye_angles_rad: np.ndarray
    activations: np.ndarray
    mechanics: MechanicsConfig
    px_deg: float
    targets_deg: np.ndarray | None = None


@dataclass(frozen=True)
class RecordedEpisode:
    """A recorded episode with pictures, number i_episode of them; trial: -1 in training."""

    training_iteration: int
    is_trial: bool
    trial: int
    start_error_deg: float
    i_episode: int = -1


def scenes(bag: Bag) -> list[Scene]:
    """Return three scenes each from before, during and after learning, as far as they are there.

    Raises InputError for a bag without pictures.
    """
    pictured = pictured_episodes(bag)
    eyes = bag.vectors("eye_states", "muscle_activations")
    stages = chosen_stages(_episodes(pictured))
    return [
        _scene(bag, pictured, eyes, episode, caption)
        for caption, episodes in stages
        for episode in episodes
    ]


def _episodes(pictured: PicturedEpisodes) -> list[RecordedEpisode]:
    names = ("training_iteration", "phase", "trial", "vergence_error_deg")
    episodes = []
    for i_episode, rows in enumerate(pictured.rows):
        training, phase, trial, error_deg = (pictured.truth.column(n)[rows[0]] for n in names)
        episodes.append(
            RecordedEpisode(int(training), phase == TEST, int(trial), float(error_deg), i_episode)
        )
    return episodes


def chosen_stages(episodes: Sequence[RecordedEpisode]) -> list[tuple[str, list[RecordedEpisode]]]:
    """Return the captions of the stages and their episodes.

    Before and after learning the same trials, where there are some in both, of errors as different
    as can be; during learning whatever there is, evenly spread. An episode that starts without an
    error has nothing to show.
    """
    moving = [e for e in episodes if abs(e.start_error_deg) >= _LEAST_START_ERROR_DEG]
    episodes = moving or list(episodes)
    ends = [
        min(e.training_iteration for e in episodes),
        max(e.training_iteration for e in episodes),
    ]
    before, after = (
        _trials_first([e for e in episodes if e.training_iteration == end]) for end in ends
    )
    if ends[0] == ends[1]:
        return [(_after(ends[0]), _spread(before))]
    common = {e.trial for e in before} & {e.trial for e in after}
    if common:
        before, after = ([e for e in of_stage if e.trial in common] for of_stage in (before, after))
    during = _trials_first([e for e in episodes if ends[0] < e.training_iteration < ends[1]])
    stages = [(_after(ends[0]), _by_error(before))]
    stages += [(_after(e.training_iteration), [e]) for e in _spread(during)]
    return [*stages, (_after(ends[1]), _by_error(after))]


def _after(training_iteration: int) -> str:
    if training_iteration == 0:
        return "before learning"
    return f"after {training_iteration:,} training iterations"


def _trials_first(episodes: Sequence[RecordedEpisode]) -> list[RecordedEpisode]:
    trials = [e for e in episodes if e.is_trial]
    return trials or list(episodes)


def _by_error(episodes: Sequence[RecordedEpisode]) -> list[RecordedEpisode]:
    return _spread(sorted(episodes, key=lambda e: (e.start_error_deg, e.trial)))


def _spread(episodes: Sequence[RecordedEpisode]) -> list[RecordedEpisode]:
    n_scenes = min(SCENES_PER_STAGE, len(episodes))
    chosen = np.linspace(0, len(episodes) - 1, n_scenes).round().astype(int)
    return [episodes[i] for i in chosen]


def _scene(
    bag: Bag,
    pictured: PicturedEpisodes,
    eyes: Mapping[str, VectorTable],
    episode: RecordedEpisode,
    caption: str,
) -> Scene:
    truth, settings = pictured.truth, evaluation_settings_of(bag)
    wanted = truth.stamps_ns[pictured.rows[episode.i_episode]]
    pairs = [dict(bag.images(topic, wanted.tolist())) for topic in PICTURES]
    fixation = settings.fixation_iterations
    most = _MOST_FIXATIONS * fixation if fixation else _MOST_ITERATIONS
    stamps_ns = [s for s in wanted.tolist() if all(s in pair for pair in pairs)][:most]
    rows = truth.at(np.array(stamps_ns))
    has_targets = fixation and (episode.is_trial or settings.gives_targets)
    mechanics = settings.tested_plant(episode.training_iteration).mechanics
    tonic = Musculature(mechanics).tonic_activation
    errors = ERRORS[: 1 if settings.plant.turning_space == PAIR else None]
    return Scene(
        caption,
        np.stack([[pair[s] for pair in pairs] for s in stamps_ns]),
        np.stack([truth.column(f"{name}_error_deg")[rows] for name in errors], axis=1),
        truth.column("metabolic_rate_w")[rows],
        _at(eyes["eye_states"], EYE_STATE_NAMES, stamps_ns, np.zeros(len(EYE_STATE_NAMES))),
        _at(eyes["muscle_activations"], MUSCLE_NAMES, stamps_ns, tonic),
        mechanics,
        settings.criteria(episode.training_iteration).px_deg,
        np.stack([truth.column(name)[rows] for name in TARGET_NAMES], axis=1)
        if has_targets
        else None,
    )


def _at(
    table: VectorTable, names: Sequence[str], stamps_ns: Sequence[int], otherwise: np.ndarray
) -> np.ndarray:
    """Return columns (n, n_names) of a table at stamps (n,); a plant may leave out what rests."""
    rows = table.at(np.array(stamps_ns))
    columns = [
        table.column(name)[rows] if name in table.names else np.full(len(rows), resting)
        for name, resting in zip(names, otherwise, strict=True)
    ]
    return np.stack(columns, axis=1)
