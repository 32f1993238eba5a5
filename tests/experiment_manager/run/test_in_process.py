"""A run in one process that fails leaves a whole bag, up to the failure, whatever failed."""

import signal
from collections.abc import Iterator
from pathlib import Path

import pytest

from active_binocular_vision.commands.run import main
from experiment_manager import Bag
from experiment_manager.loop import InProcessLoop, Step
from eye_plant import Episode
from lockstep import DivergenceError, InputError
from tests.graph_harness import small_run


@pytest.fixture(autouse=True)
def _signals() -> Iterator[None]:
    """Leave the handlers of signals as they were: a run takes them over."""
    numbers = signal.SIGINT, signal.SIGTERM, signal.SIGHUP
    before = {number: signal.getsignal(number) for number in numbers}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.mark.parametrize("error", [DivergenceError("it"), InputError("it"), OSError("it")])
def test_a_run_that_fails_closes_its_bag(
    error: Exception, pictures: Path, tmp_path: Path, monkeypatch, capsys
) -> None:
    run_episode, calls = InProcessLoop.run_episode, iter(range(100))

    def fails(self: InProcessLoop, episode: Episode) -> Iterator[Step]:
        if next(calls) == 6:
            raise error
        return run_episode(self, episode)

    monkeypatch.setattr(InProcessLoop, "run_episode", fails)
    out = tmp_path / "run"
    assert main([*small_run(pictures, 20), "--in-process", "--out", str(out)]) == 3
    assert capsys.readouterr().err.count("error: ") == 1
    bag = Bag(out / "bag")
    assert all(file.complete for file in bag.files)
    # Four trials of 20 iterations and two episodes of 10, each with its first observation.
    assert len(bag.vectors("ground_truth")["ground_truth"].stamps_ns) == 4 * 21 + 2 * 11


def test_a_run_whose_states_do_not_fit_closes_its_bag(
    pictures: Path, tmp_path: Path, monkeypatch, capsys
) -> None:
    def fails(self: InProcessLoop, paths: object) -> None:
        raise InputError("it does not fit")

    monkeypatch.setattr(InProcessLoop, "restore", fails)
    out = tmp_path / "run"
    assert main([*small_run(pictures, 20), "--in-process", "--out", str(out)]) == 2
    assert "error: it does not fit" in capsys.readouterr().err
    assert not (out / "bag").exists(), "nothing was recorded"
