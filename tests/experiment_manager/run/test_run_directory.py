"""A run on disk goes on from its newest checkpoint, with its bag or without it."""

import dataclasses
import errno
import json
import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import active_binocular_vision
from active_binocular_vision.commands.evaluate import main as evaluate
from active_binocular_vision.commands.run import main as run_experiment
from active_binocular_vision.figures.runs.learning_curve import learning_curve
from experiment_manager import Bag, ExperimentManagerConfig
from experiment_manager.run import hold
from experiment_manager.run.config_file import configuration_text
from experiment_manager.run.run_directory import Run
from experiment_manager.sections import DEFAULTS, sections_of_nodes
from lockstep import InputError, flatten, write_state
from lockstep.wire.topics import GROUND_TRUTH_NAMES, TRAINING, reward_names
from tests.pair import HORIZONTAL_RECTI

PERIOD_NS = 100_000_000
SMALL = ExperimentManagerConfig(
    n_training_iterations=60,
    test_iterations=(0, 30),
    n_training_stimuli=2,
    n_test_stimuli=1,
    n_stimuli_per_test=1,
    test_distances_m=(2.0, 4.0),
    iterations_per_trial=4,
)
Drive = Callable[[Run, int], None]


def _config(directory: Path, *, resume: bool = False) -> ExperimentManagerConfig:
    return dataclasses.replace(
        SMALL,
        run_directory=str(directory),
        resume=resume,
        model="M_C",
        metabolic_cost_weight=0.1,
    )


def _begin(directory: Path) -> Run:
    directory.mkdir()
    configuration = DEFAULTS | sections_of_nodes(
        {"experiment_manager": flatten(_config(directory))}
    )
    (directory / "config.yaml").write_text(configuration_text(configuration))
    return Run(_config(directory))


@pytest.fixture
def drive(vector_bytes: Callable[..., bytes]) -> Drive:
    """Return a function that makes the episodes of a run up to a place, with invented numbers."""

    def observe(run: Run, iteration: int) -> None:
        episode = run.episode()
        number = episode.first_observation + iteration
        draw = np.random.default_rng(number).random(4)
        values = dict.fromkeys(GROUND_TRUTH_NAMES, 0.0) | {
            "phase": episode.phase,
            "test": episode.test,
            "trial": episode.trial,
            "iteration": iteration,
            "training_iteration": episode.training_iteration
            + (iteration if episode.phase == TRAINING else 0),
            "observation": number,
            "vergence_error_deg": draw[0],
            "metabolic_rate_w": draw[1],
            "optimal_metabolic_rate_w": 0.1,
        }
        reward = dict.fromkeys(reward_names(), 0.0) | {
            "reconstruction_error_coarse": draw[2],
            "reconstruction_error_fine": draw[3],
            "metabolic_rate_w": draw[1],
        }
        is_last = iteration == episode.n_iterations
        run.progress.add_truth(np.array(list(values.values())), is_last)
        run.progress.add_activations(episode.phase, np.zeros(len(HORIZONTAL_RECTI)))
        tables = {
            "ground_truth": values,
            "muscle_activations": dict.fromkeys(HORIZONTAL_RECTI, 0.0),
        }
        if not is_last:
            iteration_of_run = episode.training_iteration + iteration
            run.progress.add_reward(
                episode.phase, iteration_of_run, np.array(list(reward.values()))
            )
            tables["reward"] = reward
        stamp_ns = number * PERIOD_NS
        for topic, table in tables.items():
            message = vector_bytes(list(table), list(table.values()), stamp_ns)
            run.writer.write(topic, message, stamp_ns)

    def drive_to(run: Run, place: int) -> None:
        while run.place < place:
            for iteration in range(run.episode().n_iterations + 1):
                observe(run, iteration)
            run.end_episode()

    return drive_to


def _commit(run: Run) -> None:
    paths = run.state_paths(("sparse_coder", "vergence_rl"))
    for name, path in paths.items():
        write_state(path, name, {"place": np.array(run.place)})
    run.commit(paths)


def _end(run: Run, drive: Drive) -> dict[str, Any]:
    drive(run, len(run.protocol))
    _commit(run)
    run.finish()
    run.close()
    results: dict[str, Any] = json.loads((run.directory / "results.json").read_text())
    return results


def test_a_run_that_never_began_leaves_nothing_of_its_own(tmp_path: Path) -> None:
    Run(_config(tmp_path / "new")).close()
    assert not (tmp_path / "new").exists()
    _begin(tmp_path / "configured").close()
    assert [path.name for path in (tmp_path / "configured").iterdir()] == ["config.yaml"]


def test_a_config_yaml_that_is_no_text_is_refused(tmp_path: Path) -> None:
    (tmp_path / "config.yaml").write_bytes(b"\xff")
    with pytest.raises(InputError, match=r"config\.yaml: expected text in UTF-8"):
        Run(_config(tmp_path))


def test_a_run_has_its_directory_until_it_is_closed(tmp_path, drive, monkeypatch) -> None:
    monkeypatch.setattr(hold, "_PATIENCE_S", 0.0)
    first = _begin(tmp_path / "run")
    _commit(first)
    with pytest.raises(InputError, match="expected a run at rest, another process is making it"):
        Run(_config(tmp_path / "run", resume=True))
    first.close()
    # One that is refused leaves it to the next one.
    with pytest.raises(InputError, match="was 60, is 20"):
        Run(dataclasses.replace(first._config, resume=True, n_training_iterations=20))
    assert _end(Run(_config(tmp_path / "run", resume=True)), drive)["tests"]


def test_a_run_that_ended_before_its_first_episode_goes_on(tmp_path: Path, drive: Drive) -> None:
    first = _begin(tmp_path / "run")
    _commit(first)
    first.close()
    resumed = Run(_config(tmp_path / "run", resume=True))
    assert _end(resumed, drive)["tests"]


def test_a_disk_that_refuses_leaves_what_was_recorded(tmp_path, drive, monkeypatch) -> None:
    run = _begin(tmp_path / "run")
    _commit(run)
    drive(run, 2)
    n_recorded = 2 * (SMALL.iterations_per_trial + 1)
    run.writer.release(n_recorded * PERIOD_NS)

    def refuse(descriptor: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as full:
        full.setattr(os, "fsync", refuse)
        with pytest.raises(OSError, match="No space left"):
            run.commit_bag()
    run.close()
    bag = Bag(run.directory / "bag")
    assert len(bag.stamps_ns("ground_truth")) == n_recorded
    resumed = Run(_config(run.directory, resume=True))
    assert _end(resumed, drive)["tests"]


def _interrupted(directory: Path, drive: Drive, place: int) -> Path:
    """Make a run with a checkpoint after so many episodes; return a copy that lacks the bag."""
    first = _begin(directory)
    drive(first, place)
    _commit(first)
    drive(first, place + 1)
    first.close()
    return _copied_without_bag(directory, directory.with_name("second"))


def _copied_without_bag(directory: Path, to: Path) -> Path:
    to.mkdir()
    shutil.copy(directory / "config.yaml", to)
    shutil.copytree(directory / "checkpoints", to / "checkpoints")
    return to


@pytest.fixture
def undisturbed(tmp_path: Path, drive: Drive) -> dict[str, Any]:
    return _end(_begin(tmp_path / "undisturbed"), drive)


# Two conditions and a test of 9 trials: amid the first test, in training, amid the second test.
@pytest.mark.parametrize("place", [5, 10, 14, 24])
def test_a_copied_checkpoint_is_enough_to_go_on(tmp_path, drive, undisturbed, place) -> None:
    directory = _interrupted(tmp_path / "first", drive, place)
    second = Run(_config(directory, resume=True))
    assert second.place == place
    observation = second.episode().first_observation
    assert _end(second, drive) == undisturbed

    finished = active_binocular_vision.Run(directory)
    assert finished.recorded.first_observation == observation
    kept = [test.trials.training_iteration for test in finished.recorded.tests]
    tests = [segment for segment in second.protocol.segments if segment.i_test >= 0]
    assert kept == [test.training_iteration for test in tests if test.first >= place]
    assert learning_curve(directory).is_file()


def test_pictures_are_listened_to_around_a_sampled_episode(tmp_path: Path, drive: Drive) -> None:
    # 9 trials, 3 episodes, 9 trials, 3 episodes, 9 trials; sampled: the first of each test.
    config = dataclasses.replace(
        _config(tmp_path / "run"), pictures_every_n_episodes=0, pictures_every_n_trials=9
    )
    run = Run(config)
    sampled = [0, 12, 24]
    for place in range(len(run.protocol)):
        drive(run, place)
        expected = any(place - 1 <= s < place + 10 for s in sampled)
        assert run.takes_pictures_soon() == expected
    run.close()


def _killed(run: Run, to: Path) -> Path:
    """Return a copy of what a run that is killed now leaves behind."""
    shutil.copytree(run.directory, to)
    run.close()
    return to


def _ends_with_a_bag_from(
    place: int, directory: Path, drive: Drive, *, goes_on_at: int
) -> dict[str, Any]:
    """Resume a run, which goes on at a checkpoint, to its end; return its results."""
    run = Run(_config(directory, resume=True))
    assert run.place == goes_on_at
    results = _end(run, drive)
    stamps_ns = Bag(directory / "bag").stamps_ns("ground_truth")
    assert (np.diff(stamps_ns) == PERIOD_NS).all()
    assert stamps_ns[0] == run.protocol.episode(place).first_observation * PERIOD_NS
    return results


@pytest.mark.parametrize("committed", [10, 13])
def test_the_next_interruption_finds_the_new_bag(tmp_path, drive, undisturbed, committed) -> None:
    second = Run(_config(_interrupted(tmp_path / "first", drive, 10), resume=True))
    if committed > 10:
        drive(second, committed)
        _commit(second)
    drive(second, committed + 1)
    directory = _killed(second, tmp_path / "killed")
    assert _ends_with_a_bag_from(10, directory, drive, goes_on_at=committed) == undisturbed


def test_an_older_checkpoint_without_its_bag_is_enough_too(tmp_path, drive, undisturbed) -> None:
    first = _begin(tmp_path / "first")
    for place in (5, 10):
        drive(first, place)
        _commit(first)
    first.close()
    second = Run(_config(_copied_without_bag(first.directory, tmp_path / "second"), resume=True))
    drive(second, 11)
    directory = _killed(second, tmp_path / "killed")
    shutil.rmtree(max((directory / "checkpoints").iterdir()))
    assert _ends_with_a_bag_from(5, directory, drive, goes_on_at=5) == undisturbed


def test_what_is_not_in_the_bag_is_not_compared(tmp_path, drive, capsys) -> None:
    directory = _interrupted(tmp_path / "first", drive, 10)
    _end(Run(_config(directory, resume=True)), drive)
    assert evaluate([str(directory)]) == 0
    assert "The bag begins with observation" in capsys.readouterr().out

    path = directory / "results.json"
    document = json.loads(path.read_text())
    document["tests"][-1]["n_trials"] += 1
    path.write_text(json.dumps(document))
    assert evaluate([str(directory)]) == 1


def test_a_bag_that_lacks_a_file_is_refused(tmp_path: Path, drive: Drive) -> None:
    run = _begin(tmp_path / "run")
    for place in (5, 10):
        drive(run, place)
        _commit(run)
    run.close()
    (run.directory / "bag" / "bag_0.mcap").unlink()
    with pytest.raises(InputError, match=r"bag_0\.mcap"):
        Run(_config(run.directory, resume=True))


def test_a_run_ends_from_its_last_checkpoint_alone(small_run, tmp_path, capsys) -> None:
    directory = _copied_without_bag(small_run, tmp_path / "copy")
    assert run_experiment(["--in-process", "--resume", str(directory)]) == 0
    said = "".join(capsys.readouterr())
    assert "bag: not here; a new one begins at this point" in said
    assert (directory / "results.json").read_text() == (small_run / "results.json").read_text()
