"""What is cleared away before a run is taken up, and what is not."""

import os
from pathlib import Path

from mcap.writer import Writer

from experiment_manager.bag.writer import BagWriter
from experiment_manager.run.attempt import goes_on, holds_observations
from lockstep.wire.topics import TOPIC_TYPES


def test_what_is_cleared_away_is_a_bag_of_this_run(tmp_path: Path) -> None:
    bag = tmp_path / "bag"
    with BagWriter(bag, TOPIC_TYPES, {}) as writer:
        writer.write("/diagnostics", bytes(100), 0)
        writer.commit()
        writer.write("/clock", bytes(100), 0)
    (bag / "notes.txt").touch()
    assert not goes_on(tmp_path)
    assert [path.name for path in bag.iterdir()] == ["notes.txt"]
    (bag / "notes.txt").unlink()
    assert not goes_on(tmp_path)
    assert not bag.exists()
    bag.mkdir()
    with (bag / "bag_0.mcap").open("wb") as file:  # as somebody else records one
        theirs = Writer(file)
        theirs.start()
        theirs.add_attachment(0, 0, "theirs", "", os.urandom(10**5))
        theirs.finish()
    assert not goes_on(tmp_path)
    assert (bag / "bag_0.mcap").is_file()


def test_what_a_bag_holds(tmp_path: Path) -> None:
    bag = tmp_path / "bag"
    assert not holds_observations(bag)
    with BagWriter(bag, TOPIC_TYPES, {}) as writer:
        writer.write("/diagnostics", bytes(100), 0)
        writer.commit()
        assert not holds_observations(bag)
        writer.write("episode", bytes(100), 0)
    assert holds_observations(bag)
    # One that cannot be read is removed only if it has no room for an observation.
    (tmp_path / "cut_off").mkdir()
    (tmp_path / "cut_off" / "bag_0.mcap").write_bytes(b"\x89MCAP")
    assert not holds_observations(tmp_path / "cut_off")
    (tmp_path / "cut_off" / "bag_0.mcap").write_bytes(bytes(10**6))
    assert holds_observations(tmp_path / "cut_off")
