"""Checkpoints: valid with their manifest only, and damage is said, not resumed from."""

import json
import shutil
from pathlib import Path
from typing import Any

import pytest

from experiment_manager.run import checkpoint
from experiment_manager.run.checkpoint import Manifest
from experiment_manager.run.progress import ProgressState, Sums
from lockstep.errors import InputError

PROGRESS = ProgressState([], Sums(0.1 + 0.2, 1.0, 3), Sums(), [0.5])
PARAMETERS = {"vergence_rl": {"cacla.discount": 0.1 + 0.2, "highest_activations": [0.2, 0.1]}}


def _commit(checkpoints: Path, place: int, lasting: tuple[int, ...] = (), **changes: Any) -> Path:
    directory = checkpoint.place_directory(checkpoints, place)
    directory.mkdir(parents=True, exist_ok=True)
    state = directory / "coder.npz"
    state.write_bytes(f"state after {place}".encode())
    values: dict[str, Any] = {
        "place": place,
        "parameters": PARAMETERS,
        "bag_files": ("bag_0.mcap",),
        "state_hashes": {state.name: checkpoint.hash_of(state)},
        "progress": PROGRESS,
    }
    checkpoint.commit(checkpoints, Manifest(**(values | changes)), lasting)
    return directory


def _newest(checkpoints: Path) -> tuple[Manifest, Path]:
    found = checkpoint.newest(checkpoints)
    assert found is not None
    return found


def test_none_yet(tmp_path: Path) -> None:
    assert checkpoint.newest(tmp_path) is None
    assert checkpoint.newest(tmp_path / "missing") is None


def test_a_manifest_comes_back_as_it_was(tmp_path: Path) -> None:
    directory = _commit(tmp_path, 12)
    manifest, where = _newest(tmp_path)
    assert where == directory
    assert manifest == Manifest(
        12,
        PARAMETERS,
        ("bag_0.mcap",),
        {"coder.npz": checkpoint.hash_of(directory / "coder.npz")},
        PROGRESS,
    )


def test_the_newest_is_the_one_furthest_on(tmp_path: Path) -> None:
    for place in (9, 10, 100, 99):
        _commit(tmp_path, place)
    assert _newest(tmp_path)[0].place == 100


@pytest.mark.parametrize(("lasting", "kept"), [((), [40, 50]), ((10, 30), [10, 30, 40, 50])])
def test_the_last_two_are_kept_and_those_that_are_to_stay(tmp_path, lasting, kept) -> None:
    for place in (0, 10, 20, 30, 40, 50):
        _commit(tmp_path, place, lasting)
    assert [int(path.name) for path in sorted(tmp_path.iterdir())] == kept


def test_states_without_a_manifest_are_no_checkpoint_and_go_with_the_next(tmp_path: Path) -> None:
    _commit(tmp_path, 1)
    # Killed after the states were written, before the manifest was.
    torn = checkpoint.place_directory(tmp_path, 2)
    torn.mkdir()
    (torn / "coder.npz").write_bytes(b"half")
    (torn / "manifest.json.part").write_text("{")
    assert _newest(tmp_path)[0].place == 1
    _commit(tmp_path, 3)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["000000001", "000000003"]


def test_only_its_own_checkpoints_are_looked_at_and_deleted(tmp_path: Path) -> None:
    other, checkpoints = tmp_path / "other", tmp_path / "checkpoints"
    theirs = _commit(other, 1)
    checkpoints.mkdir()
    (checkpoints / theirs.name).symlink_to(theirs)  # to go on from another run's
    (checkpoints / "figures").mkdir()
    shutil.copytree(theirs, checkpoints / "the best")
    for place in (2, 3, 4):
        _commit(checkpoints, place)
    assert checkpoint.newest(other) is not None
    assert checkpoint.places(checkpoints) == [1, 3, 4]
    assert (checkpoints / "figures").is_dir()
    assert (checkpoints / "the best" / "manifest.json").is_file()


def test_committing_the_same_place_again(tmp_path: Path) -> None:
    _commit(tmp_path, 1)
    _commit(tmp_path, 1, bag_files=("bag_0.mcap", "bag_1.mcap"))
    assert _newest(tmp_path)[0].bag_files == ("bag_0.mcap", "bag_1.mcap")


@pytest.mark.parametrize("damage", [b"", b"state after", None])
def test_a_changed_or_missing_state_is_an_error(tmp_path: Path, damage: bytes | None) -> None:
    _commit(tmp_path, 1)
    state = _commit(tmp_path, 2) / "coder.npz"
    if damage is None:
        state.unlink()
    else:
        state.write_bytes(damage)
    with pytest.raises(InputError, match=r"000000002: coder\.npz is missing or was changed") as e:
        checkpoint.newest(tmp_path)
    assert "delete this directory to continue from the checkpoint before" in str(e.value)


@pytest.mark.parametrize(
    "text",
    ["[]", "null", "3", '{"version": 3}', '{"version": 3, "place": 2, "x": 3}', "\x00"],
)
def test_a_damaged_manifest_is_an_error(tmp_path: Path, text: str) -> None:
    (_commit(tmp_path, 1) / "manifest.json").write_text(text)
    with pytest.raises(InputError, match="000000001"):
        checkpoint.newest(tmp_path)


def test_a_manifest_cut_off_anywhere_is_an_error(tmp_path: Path) -> None:
    manifest = _commit(tmp_path, 1) / "manifest.json"
    whole = manifest.read_bytes()
    for n_bytes in range(len(whole)):
        manifest.write_bytes(whole[:n_bytes])
        with pytest.raises(InputError, match="expected a manifest"):
            checkpoint.newest(tmp_path)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("place", "2"),
        ("place", -1),
        ("place", True),
        ("parameters", 3),
        ("parameters", {"vergence_rl": 3}),
        ("bag_files", "bag_0.mcap"),
        ("bag_files", [1]),
        ("bag_files", None),
        ("state_hashes", []),
        ("state_hashes", {"../../secret": "0"}),
        ("progress", [1]),
        ("progress", {}),
        ("version", 99),
    ],
)
def test_a_manifest_of_other_values_is_an_error(tmp_path: Path, name: str, value: Any) -> None:
    manifest = _commit(tmp_path, 1) / "manifest.json"
    document = json.loads(manifest.read_text())
    manifest.write_text(json.dumps(document | {name: value}))
    with pytest.raises(InputError, match="expected a manifest"):
        checkpoint.newest(tmp_path)


def test_everyone_comes_in_order(tmp_path: Path) -> None:
    for place in (9, 10):
        _commit(tmp_path, place)
    assert [m.place for m, _ in checkpoint.everyone(tmp_path)] == [9, 10]
