"""State files: there whole or not at all, and nothing else is taken for one."""

import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lockstep import InputError, read_state, write_state

STATE = {
    "weights": np.linspace(-1.0, 1.0, 600).reshape(20, 30),
    "steps": np.array(12),
    "picture": np.arange(6, dtype=np.float32).reshape(2, 3),
}


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """Return the path of a state file of a coder."""
    path = tmp_path / "state.npz"
    write_state(path, "coder", STATE)
    return path


def test_arrays_come_back_bit_for_bit(path: Path) -> None:
    state = read_state(path, "coder")
    assert set(state) == set(STATE)
    for name, array in STATE.items():
        assert state[name].dtype == array.dtype
        assert state[name].shape == array.shape
        assert state[name].tobytes() == array.tobytes()


def test_the_same_state_is_the_same_file(path: Path, tmp_path: Path) -> None:
    # Checkpoints are compared by their hashes.
    write_state(tmp_path / "again.npz", "coder", STATE)
    assert (tmp_path / "again.npz").read_bytes() == path.read_bytes()


def test_a_new_state_replaces_the_old_one_and_nothing_stays_beside_it(path: Path) -> None:
    write_state(path, "coder", {"steps": np.array(13)})
    assert int(read_state(path, "coder")["steps"]) == 13
    assert os.listdir(path.parent) == [path.name]


def test_cut_off_anywhere_is_refused(path: Path) -> None:
    whole = path.read_bytes()
    for n_bytes in (*range(0, len(whole), max(1, len(whole) // 60)), len(whole) - 1):
        path.write_bytes(whole[:n_bytes])
        with pytest.raises(InputError, match=r"state\.npz: expected a state of coder"):
            read_state(path, "coder")


def test_a_changed_byte_is_never_taken_for_the_state(path: Path) -> None:
    whole = path.read_bytes()
    n_refused = 0
    for place in range(0, len(whole), max(1, len(whole) // 200)):
        changed = bytearray(whole)
        changed[place] ^= 0x55
        path.write_bytes(changed)
        try:
            state = read_state(path, "coder")
        except InputError:
            n_refused += 1
            continue
        # A byte of the archive's own book-keeping, such as a date: the arrays are untouched.
        assert all(state[name].tobytes() == array.tobytes() for name, array in STATE.items())
    assert n_refused > 100


@pytest.mark.parametrize("content", [b"", b"text", b"\x93NUMPY\x01\x00", os.urandom(3000)])
def test_foreign_files_are_refused(path: Path, content: bytes) -> None:
    path.write_bytes(content)
    for place in (path, path.parent, path.parent / "none.npz"):
        with pytest.raises(InputError, match=f"{place}: expected a state of coder"):
            read_state(place, "coder")


def test_another_nodes_state_is_refused(path: Path) -> None:
    with pytest.raises(InputError, match="expected a state of agent, version 1; got coder"):
        read_state(path, "agent")


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        ({"__kind__": "coder", "__version__": 2}, "state of coder, version 1; got coder, .* 2"),
        ({"__kind__": "coder", "__version__": "2.0"}, "state of coder, version 1; got coder, .* 2"),
        ({"weights": np.zeros(3)}, "got None, version None"),
        # Pickled objects are never loaded.
        ({"__kind__": "coder", "__version__": 1, "x": np.array([{}], object)}, "expected a state"),
    ],
)
def test_other_arrays_are_refused(path: Path, arrays: dict[str, Any], message: str) -> None:
    saved: dict[str, Any] = {name: np.array(values) for name, values in arrays.items()}
    np.savez(path, **saved)
    with pytest.raises(InputError, match=message):
        read_state(path, "coder")


def test_a_place_that_cannot_be_written_is_refused_and_the_old_state_stays(path: Path) -> None:
    with pytest.raises(NotADirectoryError):
        write_state(path / "below_a_file.npz", "coder", STATE)
    assert read_state(path, "coder")
