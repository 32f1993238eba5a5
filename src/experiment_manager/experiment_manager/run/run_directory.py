"""One run on disk: where it stands, its bag, its checkpoints and its results. No ROS."""

import contextlib
import datetime
import math
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import msgspec

from experiment_manager.bag.writer import BagWriter, remove_bag
from experiment_manager.config import ExperimentManagerConfig
from experiment_manager.measures.criteria import EvaluationSettings
from experiment_manager.measures.kept_trials import arrays_of, from_arrays, write_trials
from experiment_manager.measures.results import (
    RESULTS_FILE,
    CostShares,
    Results,
    Summary,
    write_document,
)
from experiment_manager.measures.tables import summary_line
from experiment_manager.measures.trials import TrialTable
from experiment_manager.protocol import make_protocol
from experiment_manager.reach import check_reach
from experiment_manager.run import checkpoint
from experiment_manager.run.checkpoint import Manifest
from experiment_manager.run.config_file import (
    CONFIG_FILE,
    check_as_written,
    check_unchanged,
    configuration_text,
    parameters_in,
)
from experiment_manager.run.hold import hold
from experiment_manager.run.picture_sample import is_sampled
from experiment_manager.run.progress import Progress
from experiment_manager.run.progress_bar import ProgressBar
from experiment_manager.run.recorded_topics import recorded_types
from experiment_manager.sections import (
    DEFAULTS,
    Configuration,
    sections_of_nodes,
)
from eye_plant import Episode
from eye_plant.config import EyesConfig
from lockstep import InputError, flatten, read_state, write_state
from lockstep.files.durable_files import replace_file
from lockstep.wire.stamps import period_ns
from lockstep.wire.topics import PARAMETER_CHANGES
from lockstep.wire.vectors import VectorBytes

TRIALS_FILE, TRIALS_KIND = "trials.npz", "trials"
# The observations of the test under way; all else in that file is kept of the tests before.
ROWS = "rows"
_MANAGER = "experiment_manager"
# What is lost with a file that a broken disk damages.
_MOST_BYTES_OF_A_FILE = 1 << 28
# On a busy machine DDS needs a good part of a second to match a new reader.
_EPISODES_AHEAD = 10


class Run:
    """Owns a run directory: a new one, or one that goes on from its newest checkpoint."""

    def __init__(self, config: ExperimentManagerConfig) -> None:
        """Raise InputError for a directory that holds a run, another run or nothing to resume.

        And for one whose config.yaml cannot be read, and a run that another process makes.
        """
        self._config = config
        self.protocol = make_protocol(config)
        self.directory = Path(config.run_directory or new_directory())
        self.run_id = config.run_id or self.directory.name
        self.progress = Progress(config.n_training_iterations, config.space)
        self.place = 0
        self.stamp_ns = 0
        self._checkpoint_place = -1
        self._newest_states: Path | None = None
        # A directory without a checkpoint is left as it is.
        found = self._newest() if config.resume else None
        self.directory.mkdir(parents=True, exist_ok=True)
        self._hold = hold(self.directory)
        try:
            self._begin(config, found)
        except BaseException:
            self._hold.close()
            raise

    def _begin(self, config: ExperimentManagerConfig, found: tuple[Manifest, Path] | None) -> None:
        """found: the checkpoint to go on from."""
        config_file = self.directory / CONFIG_FILE
        try:
            text = config_file.read_text() if config_file.exists() else ""
        except UnicodeDecodeError as error:
            raise InputError(f"{config_file}: expected text in UTF-8: {error}") from error
        of_manager = sections_of_nodes({_MANAGER: flatten(config)})
        self._parameters = parameters_in(text) | of_manager
        self._bag_is_elsewhere = False
        bag_files = self._resume(*found) if found else None
        self.writer = BagWriter(
            self.directory / "bag",
            recorded_types(config.space),
            {"run_id": self.run_id, "model": config.model, "seed": str(config.seed)},
            configuration=text,
            resume_files=bag_files,
        )
        # A new run has its first checkpoint before its first episode: so saving is known to work.
        self._checkpoint_s = time.monotonic() if config.resume else -math.inf
        self._bar = ProgressBar(self.protocol, self.place)
        if self._bag_is_elsewhere:
            self._bar.say(f"{self.directory / 'bag'}: not here; a new one begins at this point")

    # Where the run stands

    @property
    def is_over(self) -> bool:
        """Whether the last episode has been recorded."""
        return self.place == len(self.protocol)

    def episode(self) -> Episode:
        """Return the episode to be made next."""
        return self.protocol.episode(self.place, tuple(self.progress.left))

    def plant_settings(self) -> dict[str, Any]:
        """Return what the plant must have changed since its start, for the next episode."""
        return self.protocol.plant_settings(self.episode())

    def begin_episode(self) -> bytes | None:
        """Record the change that comes into force with the next episode, and return its message."""
        change = self.protocol.change(self.place)
        if change is None:
            return None
        stamp_ns = self.episode().first_observation * period_ns(self._config.mechanics.period_s)
        numbers = change.numbers()
        message = VectorBytes(list(numbers)).of(stamp_ns, list(numbers.values()))
        self.writer.write(PARAMETER_CHANGES, message, stamp_ns)
        return message

    def prepare(self) -> None:
        """Draw the episode after the next one, while the plant is busy with the next one.

        Not where it begins with what the next one leaves.
        """
        if self.place + 1 < len(self.protocol) and not self._config.tonic_return:
            self.protocol.episode(self.place + 1)

    def takes_pictures_soon(self) -> bool:
        """Return whether an episode is sampled that is close: just over, next, or soon to come.

        Whoever then begins to listen is known to the plant in time, and hears the last pictures.
        """
        places = range(
            max(self.place - 1, 0), min(self.place + _EPISODES_AHEAD, len(self.protocol))
        )
        return any(is_sampled(self._config, *self.protocol.kind(place)) for place in places)

    def end_episode(self) -> Summary | None:
        """Go on to the next episode; return the measures of a test whose last trial this was."""
        segment = self.protocol.segment(self.place)
        self.place += 1
        test = None
        if segment.i_test >= 0 and self.place == segment.first + segment.n_episodes:
            settings = self._evaluation_settings()
            criteria = settings.criteria(segment.training_iteration)
            test = self.progress.end_test(settings.iterations_per_trial, criteria)
            self._bar.say(summary_line(test))
        self._bar.advance(self.progress.running_median_error_deg)
        return test

    def _evaluation_settings(self) -> EvaluationSettings:
        """Return how the run is tested; another plant has these eyes and our cameras."""
        known = self._parameters.get("eye_plant", {}).keys() == DEFAULTS["eye_plant"].keys()
        # A head's pictures are brought to the cameras of the configuration.
        if known or self._config.space.of_joints:
            return EvaluationSettings.of(self._parameters)
        ours = {"eyes": flatten(EyesConfig(mechanics=self._config.mechanics))}
        of_manager = {n: v for n, v in self._parameters.items() if n in ("task", _MANAGER)}
        return EvaluationSettings.of(of_manager | ours)

    # Checkpoints

    def checkpoint_is_due(self) -> bool:
        """Return whether the last checkpoint is old, the bag's file large, or this one to last."""
        old = time.monotonic() - self._checkpoint_s > self._config.checkpoint_period_s
        is_large = self.writer.n_bytes > _MOST_BYTES_OF_A_FILE
        is_lasting = self.place in self._lasting and self.place != self._checkpoint_place
        return old or is_large or is_lasting

    @property
    def _lasting(self) -> frozenset[int]:
        """Places whose checkpoints stay: where tests begin, if the run is to keep its ages."""
        if not self._config.keeps_tested_checkpoints:
            return frozenset()
        return frozenset(s.first for s in self.protocol.segments if s.i_test >= 0)

    def state_paths(self, learners: Sequence[str]) -> dict[str, Path]:
        """Return where each learner is to write its state for a checkpoint here and now."""
        directory = checkpoint.place_directory(self._checkpoints, self.place)
        directory.mkdir(parents=True, exist_ok=True)
        return {name: directory.resolve() / f"{name}.npz" for name in learners}

    def states_to_load(self, learners: Sequence[str]) -> dict[str, Path]:
        """Return the state files of the newest checkpoint; none while there is none."""
        if self._newest_states is None:
            return {}
        return {name: self._newest_states.resolve() / f"{name}.npz" for name in learners}

    def commit(self, states: dict[str, Path]) -> None:
        """Make bag and states so far a checkpoint; the states have been written."""
        self.writer.commit()
        trials = checkpoint.place_directory(self._checkpoints, self.place) / TRIALS_FILE
        rows = {ROWS: self.progress.trial_table().rows}
        write_state(trials, TRIALS_KIND, rows | arrays_of(self.progress.kept_trials))
        files = (trials, *states.values())
        checkpoint.commit(
            self._checkpoints,
            Manifest(
                place=self.place,
                parameters=self._parameters,
                bag_files=tuple(self.writer.files),
                state_hashes={path.name: checkpoint.hash_of(path) for path in files},
                progress=self.progress.state(),
            ),
            self._lasting,
        )
        self._newest_states = trials.parent
        self._checkpoint_s = time.monotonic()
        self._checkpoint_place = self.place

    @property
    def _checkpoints(self) -> Path:
        return self.directory / "checkpoints"

    def _newest(self) -> tuple[Manifest, Path]:
        found = checkpoint.newest(self._checkpoints)
        if found is None:
            raise InputError(f"{self.directory}: expected a checkpoint to resume from, found none")
        return found

    def _resume(self, manifest: Manifest, states: Path) -> tuple[str, ...]:
        """Take over a checkpoint; return the files of the bag that belong to it."""
        check_unchanged(self.directory, manifest, self._parameters)
        self._newest_states = states
        self.place = self._checkpoint_place = manifest.place
        trials = read_state(states / TRIALS_FILE, TRIALS_KIND)
        table = TrialTable.saved(trials.pop(ROWS), self.progress.space)
        self.progress.restore(manifest.progress, table, from_arrays(trials))
        # A checkpoint that was copied without the bag is enough to go on.
        bag = self.directory / "bag"
        self._bag_is_elsewhere = bool(manifest.bag_files) and not (
            bag.is_dir() and any(bag.iterdir())
        )
        if not self._bag_is_elsewhere:
            return manifest.bag_files
        # Before a new bag begins: the next resumption must not look for the old files in it.
        for each, _ in checkpoint.everyone(self._checkpoints):
            checkpoint.write(self._checkpoints, msgspec.structs.replace(each, bag_files=()))
        return ()

    def describe(self, parameters: Configuration) -> None:
        """Take note of the parameters that the nodes say they run with, before the first episode.

        A run directory without config.yaml gets one of them. Raises InputError where they are not
        those of its config.yaml, where nodes contradict each other, and where the eyes cannot do
        what the protocol asks.
        """
        of_nodes = {n: values for n, values in parameters.items() if values}
        found = sections_of_nodes(of_nodes | {_MANAGER: flatten(self._config)})
        if (path := self.directory / CONFIG_FILE).exists():
            check_as_written(path, self._parameters, found)
            return
        if found.get("eye_plant", {}).keys() == DEFAULTS["eye_plant"].keys():
            check_reach(found)
        text = configuration_text(found)
        replace_file(path, text.encode())
        self._parameters = found
        self.writer.describe(text)

    def commit_bag(self) -> None:
        """Close the bag's file without a checkpoint, as where learners have no states to save."""
        self.writer.commit()
        self._checkpoint_s = time.monotonic()

    # The end

    def leave_bar(self) -> None:
        """Leave the progress bar as it stands, so that what is said next has a line of its own."""
        self._bar.close()

    def finish(self) -> None:
        """Write results.json and trials.npz from what was measured."""
        config = self._config
        weight = config.metabolic_cost_weight
        self._bar.close()
        write_trials(self.directory, self.progress.kept_trials)
        results = Results(
            model=config.model,
            profile=config.profile,
            seed=config.seed,
            iterations=config.n_training_iterations,
            commit=config.commit,
            metabolic_cost_weight=weight,
            cost_shares=CostShares(
                self.progress.cost_share("first", weight), self.progress.cost_share("last", weight)
            ),
            tests=tuple(self.progress.tests),
        )
        write_document(self.directory / RESULTS_FILE, results)

    def close(self) -> None:
        """Close the bag, whole up to the last message; one without any is removed.

        So a run that was refused before its first episode can be started again in this directory.
        """
        self._bar.close()
        with self._hold:
            self._close_bag()

    def _close_bag(self) -> None:
        self.writer.close()
        bag = self.directory / "bag"
        # After a failed write its only file may be cut off, and none of the writer's whole ones.
        if any(bag.glob("*.mcap")):
            return
        remove_bag(bag)
        with contextlib.suppress(OSError):  # it holds more, or is a mount
            self.directory.rmdir()


def new_directory() -> Path:
    """Return where a run goes that is given no directory."""
    now = datetime.datetime.now(tz=datetime.UTC)
    return Path(f"runs/{now:%Y%m%d-%H%M%S}")
