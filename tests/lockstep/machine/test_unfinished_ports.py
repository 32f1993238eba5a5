"""Ports in shared memory that a killed process has left unfinished are removed, and no others."""

import fcntl
import struct
from pathlib import Path

import pytest

from lockstep.errors import InputError
from lockstep.machine.unfinished_ports import PATIENCE_S, remove_unfinished_ports, unfinished_ports

PORT_BYTES = 52_400
FINISHED, FAILED = 2, 3


def _make(path: Path, state: int) -> None:
    path.write_bytes(struct.pack("<I", state).ljust(PORT_BYTES, b"\0"))


def never(duration_s: float) -> None:
    """Fail: nobody should wait."""
    pytest.fail(f"waited {duration_s} s")


def no_wait(duration_s: float) -> None:
    """Let no time pass."""


@pytest.mark.parametrize("content", [b"", b"\0", bytes(PORT_BYTES), b"\1".ljust(PORT_BYTES, b"\0")])
def test_whatever_is_left_of_a_port_goes(tmp_path: Path, content: bytes) -> None:
    port = tmp_path / "fastrtps_port7000"
    port.write_bytes(content)
    waited_s: list[float] = []
    assert remove_unfinished_ports(tmp_path, waited_s.append) == 1
    assert waited_s == [PATIENCE_S]
    assert not port.exists()


def test_what_is_no_unfinished_port_stays_and_costs_no_time(tmp_path: Path) -> None:
    _make(tmp_path / "fastrtps_port7000", FINISHED)
    _make(tmp_path / "fastrtps_port7411", FAILED)  # whoever comes next makes it again
    others = ("fastrtps_0123456789abcdef", "fastrtps_port7000_el", "sem.fastrtps_port7000_mutex")
    for name in others:
        (tmp_path / name).write_bytes(bytes(32))
    assert remove_unfinished_ports(tmp_path, never) == 0
    assert len(list(tmp_path.iterdir())) == 2 + len(others)


def test_a_port_that_is_just_being_made_stays(tmp_path: Path) -> None:
    port, other = tmp_path / "fastrtps_port7000", tmp_path / "fastrtps_port7411"
    _make(port, 0)
    _make(other, 0)

    def make_the_one_and_the_other_again(duration_s: float) -> None:
        _make(port, FINISHED)
        _make(tmp_path / "new", 0)  # another file, which is as young
        (tmp_path / "new").rename(other)

    assert remove_unfinished_ports(tmp_path, make_the_one_and_the_other_again) == 0
    assert port.exists()
    assert other.exists()


def test_a_port_whose_lock_is_held_stays_with_one_error(tmp_path: Path) -> None:
    port, lock = tmp_path / "fastrtps_port7000", tmp_path / "fastrtps_port7000_el"
    _make(port, 0)
    with lock.open("w") as living:
        fcntl.flock(living, fcntl.LOCK_EX)
        with pytest.raises(InputError, match=f"{port}: expected .* a living process holds"):
            remove_unfinished_ports(tmp_path, no_wait)
    assert list(unfinished_ports(tmp_path)) == [port]


def test_a_port_that_cannot_be_removed_is_named(tmp_path, monkeypatch) -> None:
    port = tmp_path / "fastrtps_port7000"
    _make(port, 0)

    def refuse(path: Path, *, missing_ok: bool) -> None:
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr(Path, "unlink", refuse)  # as of another user's, which root never sees
    with pytest.raises(
        InputError,
        match=f"{port}: expected .*cannot be removed: Operation not permitted; remove it as user "
        f"{port.owner()}",
    ):
        remove_unfinished_ports(tmp_path, no_wait)


def test_without_shared_memory_there_is_nothing_to_do(tmp_path: Path) -> None:
    assert remove_unfinished_ports(tmp_path / "none", never) == 0
