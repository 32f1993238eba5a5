"""A robot's head as a plant: episode after episode, as `EyePlant` does it for the eyes."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import cv2
import numpy as np

from eye_plant.config import EyePlantConfig
from eye_plant.episode import Episode
from eye_plant.head.head import Angles, Head
from eye_plant.mechanics.mujoco_model import MechanicsConfig
from eye_plant.observation import NOT_GIVEN_DEG, Seen
from lockstep import COMMAND_SPACES, CommandSpace, InputError
from lockstep.optics import Pinhole
from lockstep.wire.topics import EPISODE_NAMES, GROUND_TRUTH_NAMES

_KNOWN_NAMES = GROUND_TRUTH_NAMES[len(EPISODE_NAMES) + 1 :]


@dataclass(frozen=True)
class HeadObservation(Seen):
    """An observation of a head: grey pictures, and where its joints are.

    angles_rad: (n_joints,) in the order of the command space; cameras: of the left and the right
    picture, None without pictures; truth: what is known, by names of ground truth.
    """

    angles_rad: np.ndarray
    cameras: tuple[Pinhole, Pinhole] | None
    truth: Mapping[str, float]

    # Scales of a head's cameras have none, and a head is given no gaze targets.
    apart: ClassVar[tuple[np.ndarray, ...]] = ()
    given_target_deg: ClassVar[tuple[float, ...]] = NOT_GIVEN_DEG

    def commanded(self, _: CommandSpace) -> np.ndarray:
        """Return the angles (n_joints,) of the joints, in rad."""
        return self.angles_rad

    def rates_w(self, _: CommandSpace) -> np.ndarray:
        """Return no metabolic rates (0,)."""
        return np.zeros(0)

    @property
    def felt(self) -> np.ndarray:
        """The same angles: how they are measured is the head's affair."""
        return self.angles_rad

    def ground_truth_values(self) -> tuple[float, ...]:
        """Return the values of lockstep.wire.topics.GROUND_TRUTH_NAMES, NaN of what is unknown."""
        return (*self._numbers(), *(self.truth.get(name, math.nan) for name in _KNOWN_NAMES))


class HeadPlant:
    """Runs one episode after another: `begin`, then `execute` once per command."""

    def __init__(self, head: Head, config: EyePlantConfig | None = None) -> None:
        """config: of the run, if it is known. Raises InputError where the head does not fit it."""
        self.head = head
        self.command_space = _space_of(head)
        self.space = COMMAND_SPACES[self.command_space]
        self.config = config or EyePlantConfig(
            command_space=self.command_space,
            mechanics=MechanicsConfig(baseline_m=head.baseline_m),
        )
        if self.config.command_space != self.command_space:
            raise InputError(
                f"command_space: expected {self.command_space}, whose joints the head has, got "
                f"{self.config.command_space}"
            )
        if self.config.mechanics.baseline_m != head.baseline_m:
            raise InputError(
                f"eyes.mechanics.baseline_m: expected {head.baseline_m}, as the head has it, got "
                f"{self.config.mechanics.baseline_m}"
            )
        limits_rad = [head.limits_rad[name] for name in self.space.names]
        self._lowest, self._highest = np.array(limits_rad, float).T
        self._episode: Episode | None = None
        self._iteration = 0
        self._angles_rad = np.zeros(len(self.space.names))
        self._is_shown = False

    @property
    def is_waiting(self) -> bool:
        """Whether an episode is under way, so that `execute` is allowed."""
        episode = self._episode
        return episode is not None and self._iteration < episode.n_iterations

    def reconfigure(self, settings: Mapping[str, Any]) -> None:
        """Refuse any change: a schedule is for eyes."""
        if settings:
            raise InputError(f"schedule: expected none with a head, got {', '.join(settings)}")

    def begin(self, episode: Episode) -> HeadObservation:
        """Start an episode and return its observation 0; raises InputError beyond the limits."""
        asked_rad = np.array(episode.joints_rad)
        if asked_rad.shape != self._lowest.shape:
            raise InputError(
                f"joints_rad: expected {', '.join(self.space.names)}, got {asked_rad.tolist()}"
            )
        beyond = (asked_rad < self._lowest) | (asked_rad > self._highest)
        for i in np.flatnonzero(beyond):
            raise InputError(
                f"joints_rad: expected {self.space.names[i]} from {self._lowest[i]:g} to "
                f"{self._highest[i]:g} rad, the limits of the head, got {asked_rad[i]:.4f}; the "
                "distances, start errors and start_version_deg of experiment_manager decide with "
                "what episodes begin"
            )
        self._episode, self._iteration = episode, 0
        self._is_shown = self.head.show(episode.stimulus, episode.object_distance_m)
        self._turn(asked_rad)
        return self._observe(episode)

    def targets(self, names: Sequence[str], values: np.ndarray) -> np.ndarray:
        """Return the angles (n_joints,) of a command, within the limits.

        Raises InputError unless it names each joint once, with a finite value.
        """
        given = dict(zip(names, values, strict=True))
        if len(given) != len(names) or set(given) != set(self.space.names):
            raise InputError(
                f"joint_command: expected {', '.join(self.space.names)}, got {', '.join(names)}"
            )
        asked_rad = np.array([given[name] for name in self.space.names], float)
        if not np.isfinite(asked_rad).all():
            raise InputError(f"joint_command: expected finite angles, got {asked_rad.tolist()}")
        return np.clip(asked_rad, self._lowest, self._highest)

    def execute(self, targets: np.ndarray) -> HeadObservation:
        """Turn the head to angles (n_joints,) in rad; InputError when no command is expected."""
        episode = self._episode
        if episode is None or not self.is_waiting:
            raise InputError("expected a command during an episode only, got one outside")
        self._turn(targets)
        self._iteration += 1
        return self._observe(episode)

    def _turn(self, angles_rad: np.ndarray) -> None:
        names = self.space.names
        reached: Angles | None = self.head.move(dict(zip(names, angles_rad.tolist(), strict=True)))
        if reached is None:
            self._angles_rad = angles_rad
            return
        self._angles_rad = np.array([reached.get(name, math.nan) for name in names], float)
        if not np.isfinite(self._angles_rad).all():
            raise InputError(
                f"move: expected finite angles of {', '.join(names)}, got {dict(reached)}"
            )

    def _observe(self, episode: Episode) -> HeadObservation:
        truth = self._truth(episode)
        pictures = cameras = None
        if self.is_waiting:  # the last observation has none
            pictures = np.stack([_grey(picture) for picture in _pair(self.head.pictures())])
            height_px, width_px = pictures.shape[1:]
            cameras = (
                self.head.camera(0, height_px, width_px),
                self.head.camera(1, height_px, width_px),
            )
        return HeadObservation(episode, self._iteration, pictures, self._angles_rad, cameras, truth)

    def _truth(self, episode: Episode) -> dict[str, float]:
        """Return what is known: what the joints say, and what the head does."""
        vergence_deg = math.degrees(self._angles_rad[self.space.names.index("vergence")])
        known = {name: float(value) for name, value in self.head.truth().items()}
        if unknown := sorted(set(known) - set(_KNOWN_NAMES)):
            raise InputError(
                f"truth: expected some of {', '.join(_KNOWN_NAMES)}, got {', '.join(unknown)}"
            )
        truth = {"vergence_deg": vergence_deg} | known
        if "vergence_error_deg" in known:
            truth.setdefault("desired_vergence_deg", vergence_deg + known["vergence_error_deg"])
        if self._is_shown:
            truth.setdefault("object_distance_m", episode.object_distance_m)
        return truth

    def close(self) -> None:
        """Release the head."""
        self.head.close()


def settings_of(head: Head) -> dict[str, Any]:
    """Return {SECTION.NAME: value} of a run with a head; raises InputError where none can be."""
    return {"task.command_space": _space_of(head), "eyes.mechanics.baseline_m": head.baseline_m}


def _space_of(head: Head) -> str:
    """Return the name of the command space that has the head's joints; InputError where none."""
    spaces = {name: space for name, space in COMMAND_SPACES.items() if space.of_joints}
    for name, space in spaces.items():
        if set(space.names) == set(head.limits_rad):
            return name
    expected = "; or ".join(", ".join(space.names) for space in spaces.values())
    raise InputError(f"limits_rad: expected {expected}, got {', '.join(head.limits_rad)}")


def _pair(pictures: Sequence[np.ndarray]) -> Sequence[np.ndarray]:
    shapes = [np.shape(picture)[:2] for picture in pictures]
    if len(shapes) != 2 or shapes[0] != shapes[1]:
        raise InputError(f"pictures: expected two images of one size, left and right, got {shapes}")
    return pictures


def _grey(picture: np.ndarray) -> np.ndarray:
    """Return a picture (height, width), or (height, width, 3) with BGR, as grey uint8."""
    picture = np.asarray(picture)
    if picture.dtype != np.uint8 or picture.shape[2:] not in ((), (3,)) or not picture.size:
        raise InputError(
            "pictures: expected uint8 of shape (height, width), or (height, width, 3) with BGR, "
            f"got {picture.dtype} of shape {picture.shape}"
        )
    return picture if picture.ndim == 2 else cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY)
