"""A whole run in one process, without nodes: the same files, bit for bit, as a graph writes."""

import contextlib
import dataclasses
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

from experiment_manager.config import ExperimentManagerConfig
from experiment_manager.loop import Step, make_loop
from experiment_manager.measures.results import Summary
from experiment_manager.run.attempt import goes_on
from experiment_manager.run.config_file import CONFIG_FILE, read_configuration
from experiment_manager.run.picture_sample import takes_pictures
from experiment_manager.run.run_directory import Run
from experiment_manager.sections import Configuration, config_of
from experiment_manager.step_messages import StepMessages
from eye_plant import Episode, Head
from lockstep import DivergenceError, InputError
from lockstep.exit_codes import EXIT_DIVERGED, EXIT_FAULT, EXIT_INTERRUPTED
from lockstep.machine.interrupts import Interrupts
from lockstep.wire.stamps import check_stamp, period_ns
from lockstep.wire.topics import (
    GROUND_TRUTH_NAMES,
    TEST,
    reward_names,
    unsure_reward_names,
    unsure_truth_names,
)
from lockstep.wire.vectors import check_finite


def run_in_process(directory: Path, head: Head | None = None) -> int:
    """Bring a run to its end; return the exit code: 0 done, 3 a fault, 6 one that recurs.

    Interrupted, it is 130.
    directory: holds config.yaml, and whatever the run has done so far; head: in the place of the
    eyes. What is wrong here would be so again, so nothing is tried twice. Raises InputError for
    what cannot be begun.
    """
    configuration = read_configuration(directory / CONFIG_FILE)
    interrupts = Interrupts()
    try:
        resume = goes_on(directory)
        run = InProcessRun(configuration, directory, interrupts, resume=resume, head=head)
        try:
            with contextlib.closing(run):
                is_over = run.go_on()
        except InputError as error:
            return _fault(str(error), EXIT_DIVERGED)
    except OSError as error:
        return _fault(f"{directory} cannot be written: {error}; what was saved before is intact")
    except DivergenceError as error:
        return _fault(f"{error}; what was saved before is intact", EXIT_DIVERGED)
    finally:
        interrupts.stop()
    return 0 if is_over else EXIT_INTERRUPTED


def _fault(reason: str, code: int = EXIT_FAULT) -> int:
    print(f"error: {reason}", file=sys.stderr)
    return code


class InProcessRun:
    """Plant, learners and recorder of one run, driven episode by episode."""

    def __init__(
        self,
        configuration: Configuration,
        directory: Path,
        interrupts: Interrupts,
        *,
        resume: bool,
        on_test: Callable[[Summary], object] | None = None,
        head: Head | None = None,
    ) -> None:
        """directory: of the run, with its config.yaml; resume: go on from its newest checkpoint.

        on_test: called with the measures of each test that was made; head: a robot's head in the
        place of the eyes.

        Raises InputError for whatever a node would refuse, OSError when nothing can be written.
        """
        manager = config_of(ExperimentManagerConfig, configuration)
        self._config = dataclasses.replace(manager, run_directory=str(directory), resume=resume)
        self._period_ns = period_ns(self._config.mechanics.period_s)
        self._loop, self._head = make_loop(configuration, head=head), head
        self._space = self._config.space
        self._reward_names = reward_names(self._config.scales.names)
        self._messages = self._step_messages()
        self._run = Run(self._config)
        self._interrupts = interrupts
        self._on_test = on_test
        try:
            self._loop.restore(self._run.states_to_load([*self._loop.learners]))
        except (InputError, OSError):
            self.close()
            raise

    def _step_messages(self) -> StepMessages:
        return StepMessages(self._loop.plant.config, self._head)

    def go_on(self) -> bool:
        """Bring the run to its end; return whether it came there, or was interrupted before.

        Once interrupted, it stops after the episode under way, with a checkpoint; the second time,
        at once. Raises InputError for numbers that no learner takes, OSError when the disk refuses.
        """
        run = self._run
        try:
            while not run.is_over and not self._interrupts.count:
                if run.checkpoint_is_due():
                    self._checkpoint()
                self._prepare_plant()
                self._record(run.episode())
            if self._interrupts.count <= 1:
                self._checkpoint()
            if run.is_over:
                run.finish()
            return run.is_over
        finally:
            run.leave_bar()

    def _prepare_plant(self) -> None:
        """Let the plant be as the schedule has it for the next episode, and record a change."""
        plant = self._loop.plant
        before = plant.config
        plant.reconfigure(self._run.plant_settings())
        if plant.config != before:
            self._messages = self._step_messages()
        self._run.begin_episode()

    def _record(self, episode: Episode) -> None:
        run, write = self._run, self._run.writer.write
        check_stamp(episode.first_observation + episode.n_iterations, self._period_ns)
        is_sampled = takes_pictures(self._config, episode)
        for step in self._loop.run_episode(episode):
            if self._interrupts.count > 1:
                return
            run.stamp_ns = step.observation.number * self._period_ns
            if is_sampled:
                for topic, message in self._messages.large(run.stamp_ns, step):
                    write(topic, message, run.stamp_ns)
            for topic, message in self._messages.small(run.stamp_ns, step):
                write(topic, message, run.stamp_ns)
            self._measure(episode, step)
        run.writer.release(run.stamp_ns + 1)
        test = run.end_episode()
        if test is not None and self._on_test is not None:
            self._on_test(test)

    def _measure(self, episode: Episode, step: Step) -> None:
        observation, answer, progress = step.observation, step.answer, self._run.progress
        truth = np.array(observation.ground_truth_values(), dtype=np.float64)
        check_finite(truth, GROUND_TRUTH_NAMES, "ground_truth", unsure_truth_names(self._space))
        progress.add_truth(truth, is_last=answer is None)
        if answer is None or episode.phase == TEST:
            progress.add_activations(episode.phase, observation.commanded(self._space))
        if answer is not None:
            values = np.array(answer.percept.reward_values(), dtype=np.float64)
            check_finite(values, self._reward_names, "reward", unsure_reward_names(self._space))
            progress.add_reward(episode.phase, observation.training_iteration, values)

    def _checkpoint(self) -> None:
        paths = self._run.state_paths([*self._loop.learners])
        self._loop.save(paths)
        self._run.commit(paths)

    def close(self) -> None:
        """Close the bag, whole up to the last message, and release the camera."""
        try:
            self._loop.plant.close()
        finally:
            self._run.close()
