"""Whole graphs as processes, in a configuration small enough for tests, and what they recorded."""

import os
import threading
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path

from experiment_manager import Bag, ExperimentManagerConfig, VectorTable, make_protocol
from experiment_manager.loop import Step, make_loop
from experiment_manager.run.config_file import Configuration, configuration_text
from experiment_manager.sections import config_of
from eye_plant import Episode
from lockstep.machine.own_process import die_with
from lockstep.wire.stamps import period_ns
from lockstep.wire.topics import CODER_VECTORS, LEARNER_VECTORS, PLANT_VECTORS, TRAINING
from tests.command_lines import configured, set_words
from tests.patience import PATIENCE_S
from tests.supervisor import started

SCRIPTS = Path(__file__).parents[1] / "launch_scripts"
SMALL_VECTORS = (*PLANT_VECTORS, *CODER_VECTORS, *LEARNER_VECTORS)


def small_run(pictures: Path, n_iterations: int = 200, *more: str) -> list[str]:
    """Return the command line of a run of two tests of 4 trials with training between them."""
    settings = (
        "eye_plant.stimuli.size_px=64",
        "experiment_manager.test_distances_m=[1.0]",
        "experiment_manager.least_start_error_deg=0",
        "experiment_manager.pictures_every_n_episodes=7",
        "experiment_manager.pictures_every_n_trials=3",
        *more,
    )
    chosen = dict(setting.split("=", 1) for setting in settings)  # of two the last one
    return [
        "--profile",
        "paper",
        "--iterations",
        str(n_iterations),
        "--tests",
        "0",
        "--test-stimuli",
        "1",
        "--stimuli",
        str(pictures),
        *set_words(chosen),
    ]


def write_configuration(path: Path, line: Sequence[str]) -> None:
    """Write the config.yaml that a supervisor would make of a command line."""
    path.write_text(configuration_text(configured(*line)))


class NodeProcess:
    """One node started by its script, as a person would in a terminal."""

    def __init__(self, package: str, domain: int, config_file: Path, *more: str) -> None:
        script = SCRIPTS / f"{package}.sh"
        self.process = started(
            [script, "--ros-args", "--params-file", config_file, *more],
            {"ROS_DOMAIN_ID": str(domain)},
            preexec_fn=partial(die_with, os.getpid()),
        )
        self.lines: list[str] = []
        self._watchdog = threading.Timer(PATIENCE_S, self.process.kill)
        self._watchdog.start()

    def wait_for_line(self, text: str) -> str:
        """Read what the node says up to a line with that text; return the line."""
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self.lines.append(line)
            if text in line:
                return line
        raise AssertionError(f"ended without {text!r}:\n{''.join(self.lines)}")

    def finished(self, code: int = 0) -> str:
        """Wait for the end with that exit code; return all that the node said."""
        assert self.process.stdout is not None
        self.lines.extend(self.process.stdout)
        got = self.process.wait(PATIENCE_S)
        output = "".join(self.lines)
        assert got == code, f"exit code {got}:\n{output}"
        return output

    def close(self) -> None:
        """End the process, however it stands."""
        self._watchdog.cancel()
        self.process.kill()
        self.process.communicate(timeout=PATIENCE_S)


def vectors(directory: Path) -> dict[str, VectorTable]:
    """Return all small messages of a run's bag."""
    return Bag(directory / "bag").vectors(*SMALL_VECTORS)


class OracleRun:
    """The run of a configuration in this process and without ROS."""

    def __init__(self, configuration: Configuration) -> None:
        manager = config_of(ExperimentManagerConfig, configuration)
        self.protocol = make_protocol(manager)
        self.period_ns = period_ns(manager.mechanics.period_s)
        self._loop = make_loop(configuration)
        self.plant, self.coder, self.agent = self._loop.plant, self._loop.coder, self._loop.agent

    def restore(self, states: Path) -> None:
        """Take over the learners of a checkpoint's directory."""
        self._loop.restore({name: states / f"{name}.npz" for name in self._loop.learners})

    def steps(self, first: int = 0) -> Iterator[tuple[Episode, Step]]:
        """Yield all steps of all episodes from a place on; pictures last until the next step."""
        left: tuple[float, ...] = ()
        for place in range(first, len(self.protocol)):
            episode = self.protocol.episode(place, left)
            self.plant.reconfigure(self.protocol.plant_settings(episode))
            for step in self._loop.run_episode(episode):
                yield episode, step
            if episode.phase == TRAINING:
                left = tuple(step.observation.commanded(self.plant.config.space).tolist())
        self.plant.close()
