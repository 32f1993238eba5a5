"""The live view beside a real run: viewers see it, and the run's numbers are none the wiser."""

import json
import signal
import socket
import subprocess
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import psutil
import pytest

from experiment_manager.live.view import ANAGLYPH, LEARNING, RECONSTRUCTIONS, SHOWN_TOPICS
from lockstep.wire.cdr import image_array
from lockstep.wire.topics import PICTURES
from tests.foxglove_client import FoxgloveClient
from tests.graph_harness import small_run
from tests.loop_contract import assert_as_the_loop
from tests.patience import PATIENCE_S
from tests.supervisor import finished, start_supervisor

pytestmark = pytest.mark.graph

ALL_TOPICS = tuple(f"/{topic}" for topic in (*SHOWN_TOPICS, ANAGLYPH, *RECONSTRUCTIONS, LEARNING))


def _free_port() -> int:
    """Return a port that was free a moment ago, and the next one, too."""
    while True:
        with socket.socket() as one, socket.socket() as next_one:
            one.bind(("127.0.0.1", 0))
            port = int(one.getsockname()[1])
            try:
                next_one.bind(("127.0.0.1", port + 1))
            except OSError:
                continue
            return port


def _line(pictures: Path, out: Path) -> list[str]:
    # Bags keep pictures of some episodes only; viewers see all. Long enough for them to connect.
    return [*small_run(pictures, 1500), "--out", str(out)]


@contextmanager
def _watched(line: Sequence[str], port: int) -> Iterator["subprocess.Popen[str]"]:
    process = start_supervisor([*line, "--live", f":{port}"])
    try:
        yield process
    finally:
        process.kill()
        process.wait(PATIENCE_S)


def _live_view_of(supervisor_id: int) -> psutil.Process:
    (found,) = (
        child
        for child in psutil.Process(supervisor_id).children(recursive=True)
        if "experiment_manager.live.node" in child.cmdline()
    )
    return found


def test_viewers_see_the_run_and_a_stalled_one_costs_it_nothing(pictures, tmp_path) -> None:
    port, out = _free_port(), tmp_path / "run"
    with (
        _watched(_line(pictures, out), port) as run,
        FoxgloveClient(port) as stalled,
        FoxgloveClient(port) as viewer,
    ):
        stalled.subscribe(ALL_TOPICS)  # and never reads
        viewer.subscribe(ALL_TOPICS)
        viewer.receive_of_each(ALL_TOPICS, n_messages=3)
        assert (
            f"live view: http://127.0.0.1:{port + 1} in a browser; ws://127.0.0.1:{port} "
            in finished(run)
        )
    assert_as_the_loop(out)
    first, second = (image_array(m) for m in viewer.received["/left/image_raw"][:2])
    assert first.shape == second.shape == (240, 320)
    errors = [json.loads(m)["running_median_error_deg"] for m in viewer.received[f"/{LEARNING}"]]
    assert all(0.0 <= error_deg < 20.0 for error_deg in errors)


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSTOP])
def test_a_run_whose_live_view_dies_or_stops_goes_on(pictures, tmp_path, number) -> None:
    port, out = _free_port(), tmp_path / "run"
    with _watched(_line(pictures, out), port) as run, FoxgloveClient(port) as viewer:
        topics = [f"/{topic}" for topic in PICTURES]
        viewer.subscribe(topics)
        viewer.receive_of_each(topics)
        _live_view_of(run.pid).send_signal(number)
        output = finished(run)
    assert ("the live view has ended" in output) == (number == signal.SIGKILL)
    assert "fault" not in output
    assert_as_the_loop(out)
