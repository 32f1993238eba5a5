"""Saccades of two eyes with twelve muscles, learned from pictures and activations alone.

The eyes make random movements before training pictures. How each eye turned is measured in its
pictures, and a regression learns which change of activations turns both eyes as wanted. Then the
eyes look at targets 2 to 10 deg away in all directions, before pictures that they have not seen: a
first saccade, and a corrective one over what the pictures say is left.

usage: OMP_NUM_THREADS=1 .venv/bin/python docs/examples/saccades.py [MOVEMENTS [SEED [JSON]]]
"""

import dataclasses
import json
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from experiment_manager.experiment.config import ExperimentManagerConfig
from experiment_manager.experiment.protocol import make_protocol
from experiment_manager.preparation.configuration import configuration_of
from experiment_manager.preparation.request import RunRequest
from eye_plant.config import EyePlantConfig
from eye_plant.episode import Episode
from eye_plant.observation import Observation
from eye_plant.plant import EyePlant
from lockstep.configuration import build
from lockstep.wire.topics import TRAINING
from sparse_coder.movement import Movement, angles_deg, movement, rotation
from vergence_rl.saccades import Saccades

Floats = NDArray[np.float64]

PARTS = (slice(0, 6), slice(6, 12))  # the muscles of the left and of the right eye
LOWEST, HIGHEST = 0.0, 0.2  # as in the profile
# SD of the change of each activation.
STEPS = (0.002, 0.004)
NEAREST_DEG, FARTHEST_DEG = 2.0, 10.0
N_TARGETS = 400
SETTINGS = {
    "eye_plant.camera.renderer": "plane",
    "experiment_manager.protocol.test_iterations": [0],
}


class Eyes:
    """The plant, with what its pictures say of each movement."""

    def __init__(self, configuration: dict[str, dict[str, object]], seed: int) -> None:
        """seed: of the order in which scenes are shown, and of the random movements."""
        self._plant = EyePlant(build(EyePlantConfig, configuration["eye_plant"]))
        manager = build(ExperimentManagerConfig, configuration["experiment_manager"])
        self._protocol = make_protocol(dataclasses.replace(manager, seed=seed))
        self._focal_length_px = self._plant.config.camera.focal_length_px

    def episodes(self, phase: int, n_iterations: int) -> Iterator[Episode]:
        """Yield the protocol's episodes of a phase, with so many movements."""
        for i in range(len(self._protocol)):
            episode = self._protocol.episode(i)
            if episode.phase == phase:
                yield dataclasses.replace(episode, n_iterations=n_iterations + 1)

    def begin(self, episode: Episode) -> None:
        """Show a scene."""
        self._seen = self._plant.begin(episode)
        self._pictures = self._seen.pictures.copy()

    @property
    def seen(self) -> Observation:
        """The last observation."""
        return self._seen

    def axes(self) -> Floats:
        """Return the axes (2, 3, 3) of both cameras: columns right, down, forward."""
        forward, left, up = np.moveaxis(self._plant.oculomotor.eye_rotations(), 2, 0)
        return np.stack([-left, -up, forward], axis=2)

    def move(self, change: Floats) -> list[Movement]:
        """Change the activations within their limits; return how each eye turned, as it saw it."""
        before = self._pictures
        target = np.clip(self._seen.state.activations + change, LOWEST, HIGHEST)
        self._seen = self._plant.execute(target)
        self._pictures = self._seen.pictures.copy()
        return [
            movement(a, b, self._focal_length_px)
            for a, b in zip(before, self._pictures, strict=True)
        ]

    def close(self) -> None:
        """Release the camera."""
        self._plant.close()


def turns_deg(moved: Movement) -> Floats:
    """Return a movement as what the regression learns from, (3,)."""
    return np.array((moved.sideways_deg, moved.up_deg, moved.clockwise_deg))


def learned(eyes: Eyes, n_movements: int, seed: int) -> tuple[tuple[Saccades, ...], float, Floats]:
    """Return both eyes' saccades, learned from random movements, and how well those were seen.

    That is the share of movements that were refused, and the errors (n, 3) of the others in deg.
    """
    draw, both = np.random.default_rng([seed, 7]), (_new(), _new())
    n_refused, errors_deg = 0, []
    for episode in eyes.episodes(TRAINING, 9):
        eyes.begin(episode)
        for i in range(9):
            before, axes = eyes.seen.state.activations, eyes.axes()
            moved = eyes.move(draw.normal(0.0, STEPS[i % 2], 12))
            if any(m.refused for m in moved):
                n_refused += 1
                continue
            change = eyes.seen.state.activations - before
            for saccades, part, of_eye in zip(both, PARTS, moved, strict=True):
                saccades.learn(before[part], change[part], turns_deg(of_eye))
            true_deg = [angles_deg(a.T @ b) for a, b in zip(axes, eyes.axes(), strict=True)]
            errors_deg.append(np.array([turns_deg(m) for m in moved]) - true_deg)
        if both[0].n_movements >= n_movements:
            break
    share = n_refused / (n_refused + both[0].n_movements)
    return both, share, np.concatenate(errors_deg)


def _new() -> Saccades:
    return Saccades(np.full(6, LOWEST), np.full(6, HIGHEST))


def tested(eyes: Eyes, both: tuple[Saccades, ...], seed: int) -> dict[str, Floats]:
    """Return, in deg, what each of two saccades missed, and how it changed the three errors."""
    draw = np.random.default_rng([seed, 8])
    result: dict[str, list[object]] = {"missed": [], "disturbed": []}
    for _, episode in zip(range(N_TARGETS), eyes.episodes(1 - TRAINING, 2), strict=False):
        eyes.begin(episode)
        ahead = rotation(_drawn_deg(draw))[:, 2]
        target = eyes.axes()[0] @ ahead
        missed, disturbed = [], []
        for _ in range(2):
            aim = _swing_deg(ahead)
            before = _errors_deg(eyes.seen)
            now = eyes.seen.state.activations
            moved = eyes.move(
                np.concatenate(
                    [s.change(now[part], aim) for s, part in zip(both, PARTS, strict=True)]
                )
            )
            cosine = np.clip(target @ eyes.axes()[0][:, 2], -1.0, 1.0)
            missed.append(np.degrees(np.arccos(cosine)))
            disturbed.append(np.abs(_errors_deg(eyes.seen) - before))
            if moved[0].refused:
                ahead = np.array([0.0, 0.0, 1.0])  # where the target is now is not known
            else:
                ahead = rotation(turns_deg(moved[0])).T @ ahead
        result["missed"].append(missed)
        result["disturbed"].append(disturbed)
    return {name: np.array(values) for name, values in result.items()}


def _drawn_deg(draw: np.random.Generator) -> Floats:
    """Return a turn (3,) to a random target."""
    far, angle = draw.uniform(NEAREST_DEG, FARTHEST_DEG), draw.uniform(0.0, 2.0 * np.pi)
    return far * np.array([np.cos(angle), np.sin(angle), 0.0])


def _errors_deg(seen: Observation) -> Floats:
    error = seen.truth.gaze_error
    return np.array((error.horizontal_deg, error.vertical_deg, error.torsional_deg))


def _swing_deg(ahead: Floats) -> Floats:
    """Return the turn (3,) without rotation about the line of sight that leads to a direction."""
    x, y, z = ahead
    aside = np.hypot(x, y)
    swing = np.degrees(np.arctan2(aside, z)) / aside if aside > 0.0 else 0.0
    return np.array([x * swing, -y * swing, 0.0])


def main() -> None:
    """Print what was learned."""
    n_movements = int(sys.argv[1]) if len(sys.argv) > 1 else 3000
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    configuration = configuration_of(RunRequest(profile="twelve", overrides=SETTINGS), commit="")
    eyes = Eyes(configuration, seed)
    both, refused, errors_deg = learned(eyes, n_movements, seed)
    result = tested(eyes, both, seed)
    eyes.close()
    print(f"{both[0].n_movements} movements learned from, {refused:.1%} refused")
    table = {"movements": both[0].n_movements, "refused": refused}
    rows = {
        "measured turn, error sideways": errors_deg[:, 0],
        "measured turn, error up": errors_deg[:, 1],
        "measured turn, error clockwise": errors_deg[:, 2],
        "target missed after one saccade": result["missed"][:, 0],
        "target missed after two": result["missed"][:, 1],
        "horizontal error changed by the first": result["disturbed"][:, 0, 0],
        "vertical error changed": result["disturbed"][:, 0, 1],
        "cyclovergence changed": result["disturbed"][:, 0, 2],
    }
    print(f"{'|deg|':40}{'median':>8}{'90 %':>8}")
    for name, values in rows.items():
        median, most = np.percentile(np.abs(values), (50, 90))
        table[name] = {"median": round(float(median), 4), "90 %": round(float(most), 4)}
        print(f"{name:40}{median:8.3f}{most:8.3f}")
    if len(sys.argv) > 3:
        Path(sys.argv[3]).write_text(json.dumps(table, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
