"""Shared memory of dead nodes is removed, and nobody else's."""

import fcntl
import os
from pathlib import Path

import pytest
from rclpy.node import Node

from experiment_manager.supervision.shared_memory import remove_ports, remove_stale_segments
from tests.node_harness import ros_graph

DEAD, LIVING = "fastrtps_0123456789abcdef", "fastrtps_fedcba9876543210"
# Thirteen observations' pictures; with room for three, a sampled episode stands still for seconds.
LEAST_SEGMENT_BYTES = 13 * 2 * 320 * 240


def _make(directory: Path, *names: str, age_s: float = 3600.0) -> None:
    for name in names:
        path = directory / name
        path.write_bytes(b"")
        then_s = path.stat().st_mtime - age_s
        os.utime(path, (then_s, then_s))


def test_segments_of_the_dead_go_and_of_the_living_stay(tmp_path: Path) -> None:
    others = ("fastrtps_port7661", "fastrtps_port7661_el", "lttng-ust-wait-6", "fastrtps_x_el")
    _make(tmp_path, DEAD, DEAD + "_el", LIVING, LIVING + "_el", *others)
    with (tmp_path / (LIVING + "_el")).open() as living:
        fcntl.flock(living, fcntl.LOCK_EX)
        assert remove_stale_segments(tmp_path) == 1
    assert {p.name for p in tmp_path.iterdir()} == {LIVING, LIVING + "_el", *others}


def test_a_segment_whose_maker_died_before_it_had_a_lock_goes(tmp_path: Path) -> None:
    _make(tmp_path, DEAD)
    _make(tmp_path, LIVING, age_s=0.0)
    assert remove_stale_segments(tmp_path) == 1
    assert [p.name for p in tmp_path.iterdir()] == [LIVING]


def test_a_node_that_is_just_starting_keeps_its_segment(tmp_path: Path) -> None:
    _make(tmp_path, DEAD, DEAD + "_el", age_s=0.0)
    assert remove_stale_segments(tmp_path) == 0
    assert len(list(tmp_path.iterdir())) == 2


def test_ports_of_a_domain_of_our_own_go(tmp_path: Path) -> None:
    # Domain 3: 8150 to 8399.
    gone: tuple[str, ...] = (
        "fastrtps_port8161",
        "fastrtps_port8161_el",
        "sem.fastrtps_port8161_mutex",
    )
    gone += ("fastrtps_port8399", "sem.fastrtps_port8399_mutex")
    kept = ("fastrtps_port8149", "fastrtps_port8400", "fastrtps_port8163", "fastrtps_port8163_el")
    _make(tmp_path, *gone, *kept)
    with (tmp_path / "fastrtps_port8163_el").open() as living:
        fcntl.flock(living, fcntl.LOCK_EX)
        assert remove_ports(3, tmp_path) == 2
    assert {p.name for p in tmp_path.iterdir()} == set(kept)


def test_without_shared_memory_there_is_nothing_to_do(tmp_path: Path) -> None:
    assert remove_stale_segments(tmp_path / "none") == 0
    assert remove_ports(3, tmp_path / "none") == 0


def _own_segments() -> set[Path]:
    """Return the files of Fast DDS that this process, and not a test beside it, has in memory."""
    words = Path("/proc/self/maps").read_text().split()
    return {Path(word) for word in words if word.startswith("/dev/shm/fastrtps_")}


@pytest.mark.skipif(
    not os.environ.get("FASTRTPS_DEFAULT_PROFILES_FILE", "").endswith(
        "lockstep/config/fastdds.xml"
    ),
    reason="not started by launch_scripts/test.sh",
)
def test_nodes_have_room_for_the_pictures_of_an_episode() -> None:
    before = _own_segments()
    with ros_graph() as graph:
        graph.add(lambda **kwargs: Node("somebody", **kwargs))
        sizes = [path.stat().st_size for path in _own_segments() - before]
    assert max(sizes) >= LEAST_SEGMENT_BYTES
