"""What is cleared away before a run is taken up, and what is not."""

from pathlib import Path

from experiment_manager.bag.writer import BagWriter
from experiment_manager.run.attempt import holds_observations
from lockstep.wire.topics import TOPIC_TYPES


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
