"""Files of trained eyes: run directories in little, whose learners do the same."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from active_binocular_vision import FrozenLearners, Run
from active_binocular_vision.commands.examine import main as examine
from active_binocular_vision.commands.run import main as run_main
from active_binocular_vision.commands.trained import main
from active_binocular_vision.learners.evaluation import evaluated
from experiment_manager.run import checkpoint
from experiment_manager.trained import directory as trained_directory
from experiment_manager.trained import eyes_file
from experiment_manager.trained.directory import pack, run_directory, trained_eyes
from experiment_manager.trained.eyes_file import packed, unpacked
from lockstep import InputError, read_state

CONFIGURATION = "run: {}\n"


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Keep what is unpacked away from this user's cache."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path / "cache"


def test_arrays_come_back_as_they_were_but_for_sums_that_only_learning_reads() -> None:
    draw = np.random.default_rng(1)
    lower = np.tril(draw.normal(size=(5, 5)))
    # Of a feature that was never there, too.
    seen = draw.normal(size=(9, 5)) * [1.0, 0.01, 0.0, 3.0, 1e4]
    squares = seen.T @ seen
    state: dict[str, np.ndarray] = {
        "actor": draw.normal(size=(2, 7)),
        "atoms": draw.normal(size=(2, 3, 4)).astype(np.float32),
        "left_eye_squares": lower + np.tril(lower, -1).T,
        "count": np.array(3),
        "sum_squares": squares[np.triu_indices(5)],
        "lens_0_sum_squares": 2.0 * squares[np.triu_indices(5)],
        "empty": np.zeros((0, 3)),
    }
    _, states = unpacked(packed(CONFIGURATION, b"{}", 20, {"vergence_rl": state}))
    for name, array in states["vergence_rl"].items():
        assert (array.dtype, array.shape) == (state[name].dtype, state[name].shape)
        if not name.endswith("sum_squares"):
            assert np.array_equal(array, state[name])
    roots = np.sqrt(np.diag(squares))
    rounded = [
        0.0
        if 2 in (i, k)
        else round(squares[i, k] / (roots[i] * roots[k]) * 32767) / 32767 * roots[i] * roots[k]
        for i in range(5)
        for k in range(i, 5)
    ]
    for factor, name in ((1.0, "sum_squares"), (2.0, "lens_0_sum_squares")):
        found = states["vergence_rl"][name] / factor
        np.testing.assert_allclose(found, rounded, rtol=1e-12)
        np.testing.assert_allclose(found[[0, 5, 9, 12, 14]], np.diag(squares), rtol=1e-12)


def test_sums_are_rounded_more_where_a_file_would_be_too_large(monkeypatch) -> None:
    seen = np.random.default_rng(1).normal(size=(300, 60))
    squares = seen.T @ seen
    upper = np.triu_indices(60)
    states = {"vergence_rl": {"sum_squares": squares[upper]}}
    fine = packed(CONFIGURATION, b"{}", 20, states)
    most = len(fine) - 1000
    monkeypatch.setattr(eyes_file, "_MOST_BYTES", most)
    coarse = packed(CONFIGURATION, b"{}", 20, states)
    assert len(coarse) <= most
    roots = np.sqrt(np.diag(squares))
    scale = np.outer(roots, roots)[upper]
    errors = [
        np.abs(unpacked(data)[1]["vergence_rl"]["sum_squares"] - squares[upper]) / scale
        for data in (fine, coarse)
    ]
    assert errors[0].max() < 0.6 / 32767 < errors[1].max() < 0.01


def test_other_bytes_are_refused(tmp_path: Path) -> None:
    (tmp_path / "eyes").write_bytes(b"no eyes")
    with pytest.raises(InputError, match=r"/eyes: expected a file of trained eyes: "):
        run_directory(tmp_path / "eyes")


@pytest.mark.parametrize("kind", ["pair", "gaze"])
def test_learners_of_a_file_do_what_those_of_the_run_do(
    tmp_path: Path, run_of: Callable[[str], Path], kind: str
) -> None:
    run = run_of(kind)
    size = pack(run, tmp_path / "some.eyes")
    assert (tmp_path / "some.eyes").stat().st_size == size < 2e6
    directory = run_directory(tmp_path / "some.eyes")
    assert directory.name == "some"
    _, before = checkpoint.newest(run / "checkpoints") or (None, Path())
    _, after = checkpoint.newest(directory / "checkpoints") or (None, Path())
    for node in ("sparse_coder", "vergence_rl"):
        state = read_state(before / f"{node}.npz", node)
        for name, array in read_state(after / f"{node}.npz", node).items():
            assert np.array_equal(array, state[name]) or name == "sum_squares"
    assert Run(directory).document == Run(run).document
    tests = [evaluated(FrozenLearners(each)).test for each in (run, tmp_path / "some.eyes")]
    assert tests[0] == tests[1]


def test_a_name_stands_for_a_run_and_what_is_there_takes_precedence(
    tmp_path: Path, run_of: Callable[[str], Path], monkeypatch: pytest.MonkeyPatch, capsys
) -> None:
    monkeypatch.setattr(trained_directory, "FOLDER", tmp_path / "eyes")
    monkeypatch.chdir(tmp_path)
    assert main([str(run_of("pair")), "--out", "eyes/clinic.healthy.eyes"]) == 0
    assert [*trained_eyes()] == ["clinic/healthy"]
    assert examine(["clinic/healthi", "--cover"]) == 2
    assert capsys.readouterr().err.endswith("got clinic/healthi; did you mean clinic/healthy?\n")
    assert Run("clinic/healthy").results.equals(Run(run_of("pair")).results)
    line = ["--in-process", "--branch", "clinic/healthy@40", "--out", "on"]
    assert run_main([*line, "--iterations", "60", "--tests", "60"]) == 0
    assert Run("on").about["branched_at_iteration"] == 40
    (tmp_path / "clinic" / "healthy").mkdir(parents=True)
    assert run_directory("clinic/healthy") == Path("clinic/healthy")
    assert run_directory("clinic/nobody") == Path("clinic/nobody")


def test_without_the_folder_of_trained_eyes(tmp_path: Path, run_of, monkeypatch, capsys) -> None:
    monkeypatch.setattr(trained_directory, "FOLDER", tmp_path / "none" / "eyes")
    assert main([]) == 0
    assert capsys.readouterr().out == "no trained eyes come with this package\n"
    assert examine(["gaze", "--cover"]) == 2
    assert capsys.readouterr().err == (
        "error: expected a run directory or trained eyes, got gaze\n"
    )
    assert not (tmp_path / "none").exists()
    assert main([str(run_of("pair"))]) == 0
    assert [*trained_eyes()] == ["precise"]


def test_a_run_that_has_not_ended_is_refused(tmp_path: Path, run_of, capsys) -> None:
    (tmp_path / "config.yaml").write_text((run_of("pair") / "config.yaml").read_text())
    assert main([str(tmp_path), "--out", str(tmp_path / "some.eyes")]) == 2
    error = f"error: {tmp_path}: expected a run that has ended, with its checkpoint\n"
    assert capsys.readouterr().err == error
    assert not (tmp_path / "some.eyes").exists()
