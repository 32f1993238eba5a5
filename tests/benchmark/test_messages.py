"""Messages timed: the recording of a bag, and the hop between two processes."""

from pathlib import Path
from unittest import mock

import pytest
from rclpy.serialization import serialize_message

from experiment_manager.bag.reader import Bag
from experiment_manager.bag.writer import BagWriter
from lockstep.errors import InputError
from lockstep.wire.topics import REWARD_NAMES, TOPIC_TYPES
from lockstep.wire.vectors import vector_message
from tests.benchmark import messages
from tests.benchmark.messages import hop_times_ms, recording_ms
from tests.pair import COMMAND_NAMES


def _bag(directory: Path, n_commands: int) -> Path:
    with BagWriter(directory, TOPIC_TYPES, {}) as writer:
        for i in range(4):
            reward = vector_message(i, REWARD_NAMES, [float(i)] * len(REWARD_NAMES))
            writer.write("reward", serialize_message(reward), i)
        for i in range(n_commands):
            command = vector_message(i, COMMAND_NAMES, (0.1, 0.2))
            writer.write("muscle_command", serialize_message(command), i)
    return directory


def test_recording_is_timed_per_command_and_copies_all_messages(tmp_path: Path) -> None:
    bag = _bag(tmp_path / "bag", n_commands=5)
    with mock.patch.object(messages, "time", mock.Mock(perf_counter=iter((10.0, 10.5)).__next__)):
        assert recording_ms(bag, tmp_path / "copy") == pytest.approx(100.0)
    for topic in ("reward", "muscle_command"):
        ours, copied = (Bag(path).vectors(topic)[topic] for path in (bag, tmp_path / "copy"))
        assert copied.position.tolist() == ours.position.tolist()


def test_a_bag_without_commands_is_refused(tmp_path: Path) -> None:
    bag = _bag(tmp_path / "bag", n_commands=0)
    with pytest.raises(InputError, match="expected a bag with muscle commands"):
        recording_ms(bag, tmp_path / "copy")


def test_vectors_and_pictures_come_back_from_the_echo_process() -> None:
    times_ms = hop_times_ms(5)
    assert set(times_ms) == {"vector", "pictures"}
    assert times_ms["vector"] > 0.0
