"""The contract of every graph: all that it has recorded is, byte for byte, what the loop computes.

So says a run in one process, a run that was disturbed, one across two machines: see
assert_as_the_loop, and the run that the tests of whole graphs share.
"""

import json
from collections.abc import Mapping
from functools import cache
from hashlib import blake2b
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from experiment_manager import Bag
from experiment_manager.measures.results import RESULTS_FILE, read_results
from experiment_manager.run import checkpoint
from experiment_manager.run.config_file import CONFIG_FILE, read_configuration
from experiment_manager.step_messages import StepMessages
from lockstep import read_state
from lockstep.wire.topics import CAMERA_INFOS, PICTURES
from tests.graph_harness import OracleRun, small_run
from tests.made_once import made_once
from tests.supervised_run import SupervisedRun

N_TRAINING = 300
# Of both tests of small_run.
N_TRIALS = 8
PICTURE_PX = 130
SMALL = (
    "task.n_bases=32",
    f"eyes.camera.roi_width_px={PICTURE_PX}",
    f"eyes.camera.roi_height_px={PICTURE_PX}",
)
SETTINGS = (
    *SMALL,
    "experiment_manager.checkpoint_period_s=0.2",
    "experiment_manager.gap_s=8.0",
    # Disease and treatment: of the muscles, of what one eye sees, and of what must be drawn for it.
    "task.schedule=["
    "{at: 90, set: {eyes.mechanics.rest_adduction_deg: [0.0, 1.5],"
    " eyes.camera.left_blur_px: 2.5, eyes.camera.left_magnification: 1.1}},"
    "{at: 180, set: {eyes.camera.left_blur_px: 0.0, eyes.camera.left_occluded: true,"
    " eyes.noise.picture_sd: 4.0, eyes.noise.missing_pictures: 0.2,"
    " eyes.noise.activation_sd: 0.004, eyes.noise.missing_activations: 0.2}}]",
)
_SAMPLED = (*PICTURES, *CAMERA_INFOS, "features")
_Messages = Mapping[str, Mapping[int, bytes]]
_States = Mapping[str, Mapping[str, np.ndarray]]


def run_line(pictures: Path, *more: str, rule: str = "cacla") -> list[str]:
    """Return the command line of a run with a schedule and many checkpoints; more: settings."""
    chosen = f"vergence_rl.learning_rule={rule}"
    return [*small_run(pictures, N_TRAINING, *SETTINGS, chosen, *more), "--model", "M_C"]


def whole_graph(tmp_path_factory: pytest.TempPathFactory, pictures: Path) -> Path:
    """Return the directory of the run of run_line that a graph has made; not to change."""

    def make(directory: Path) -> None:
        with SupervisedRun(run_line(pictures), directory / "run") as run:
            assert run.wait() == 0, run.output()

    return made_once(tmp_path_factory, "whole_graph", make) / "run"


def assert_as_the_loop(directory: Path) -> None:
    """Check all that a finished run has recorded against the loop in this process.

    The bytes of its messages, each once and in order, of pictures and features those that there
    are; the learners of its last checkpoint; the tests of its results.
    """
    configuration = read_configuration(directory / CONFIG_FILE)
    configuration["experiment_manager"].pop("run_directory", None)
    small, large, states = _of_the_loop(json.dumps(configuration, sort_keys=True))
    bag = Bag(directory / "bag")
    for topic, expected in small.items():
        got = list(bag.messages(topic))
        if topic == "/clock":  # which the plant may repeat, as nobody misses it
            got = list(dict(got).items())
        assert [stamp_ns for stamp_ns, _ in got] == list(expected), topic
        differing = [stamp_ns for stamp_ns, message in got if message != expected[stamp_ns]]
        assert differing[:3] == [], topic
    for topic in _SAMPLED:
        for stamp_ns, message in bag.messages(topic):
            assert _digest(message) == large[topic][stamp_ns], (topic, stamp_ns)
    newest = checkpoint.everyone(directory / "checkpoints")[-1][1]
    for node, arrays in states.items():
        for name, array in read_state(newest / f"{node}.npz", node).items():
            assert array.tobytes() == arrays[name].tobytes(), (node, name)
    _assert_results_are_of(directory)


def _assert_results_are_of(directory: Path) -> None:
    """Check the results' tests against the bag, which is the loop's."""
    truth = Bag(directory / "bag").vectors("ground_truth")["ground_truth"]
    test, iteration = truth.column("test"), truth.column("iteration")
    results = read_results(directory / RESULTS_FILE)
    for i_test, summary in enumerate(results.tests):
        rows = (test == i_test) & (iteration == 20)
        assert summary.n_trials == rows.sum() > 0
        errors_deg = np.abs(truth.column("vergence_error_deg")[rows])
        assert summary.median_abs_vergence_error_deg == pytest.approx(np.median(errors_deg))
    assert len(results.tests) == test.max() + 1


@cache
def _of_the_loop(configuration: str) -> tuple[_Messages, _Messages, _States]:
    """Return {topic: {stamp: message}}, the same of digests, and the learners' states."""
    oracle = OracleRun(json.loads(configuration))
    small: dict[str, dict[int, bytes]] = {}
    large: dict[str, dict[int, bytes]] = {topic: {} for topic in _SAMPLED}
    laid_out = None
    for _, step in oracle.steps():
        if laid_out != oracle.plant.config:
            laid_out = oracle.plant.config
            messages = StepMessages(laid_out)
        stamp_ns = step.observation.number * oracle.period_ns
        for topic, message in messages.small(stamp_ns, step):
            small.setdefault(topic, {})[stamp_ns] = message
        for topic, message in messages.large(stamp_ns, step):
            large[topic][stamp_ns] = _digest(message)
    states: dict[str, Any] = {
        "sparse_coder": oracle.coder.state(),
        "vergence_rl": oracle.agent.state(),
    }
    return small, large, states


def _digest(message: bytes) -> bytes:
    return blake2b(message).digest()
