"""The live view beside a real run: viewers see it, and the run's numbers are none the wiser."""

import json
import socket
import subprocess
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import psutil
import pytest

from experiment_manager.live.view import ANAGLYPH, LEARNING, RECONSTRUCTIONS, SHOWN_TOPICS
from lockstep.wire.cdr import image_array
from tests.foxglove_client import FoxgloveClient
from tests.graph_harness import small_run
from tests.loop_contract import PICTURE_PX, SMALL, assert_as_the_loop
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
    return [*small_run(pictures, 1000, *SMALL), "--out", str(out)]


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


@pytest.mark.parametrize("is_stopped", [False, True])
def test_viewers_see_a_run_that_neither_a_stalled_one_nor_a_stopped_view_disturbs(
    pictures, tmp_path, is_stopped
) -> None:
    port, out = _free_port(), tmp_path / "run"
    with (
        _watched(_line(pictures, out), port) as run,
        FoxgloveClient(port) as stalled,
        FoxgloveClient(port) as viewer,
    ):
        stalled.subscribe(ALL_TOPICS)  # and never reads
        viewer.subscribe(ALL_TOPICS)
        viewer.receive_of_each(ALL_TOPICS, n_messages=3)
        if is_stopped:
            _live_view_of(run.pid).suspend()
        output = finished(run)
    browser = f"live view: http://127.0.0.1:{port + 1} in a browser"
    assert f"{browser}; ws://127.0.0.1:{port} " in output
    assert "the live view has ended" not in output
    assert "fault" not in output
    assert_as_the_loop(out)
    first, second = (image_array(m) for m in viewer.received["/left/image_raw"][:2])
    assert first.shape == second.shape == (PICTURE_PX, PICTURE_PX)
    errors = [json.loads(m)["running_median_error_deg"] for m in viewer.received[f"/{LEARNING}"]]
    assert all(0.0 <= error_deg < 20.0 for error_deg in errors)
