"""The live view beside a real run: viewers see it, and the run's numbers are none the wiser."""

import json
import socket
import subprocess
import sys
from pathlib import Path

import psutil

from experiment_manager.live.view import ANAGLYPH, LEARNING, RECONSTRUCTIONS, SHOWN_TOPICS
from lockstep.wire.cdr import image_array
from tests.foxglove_client import FoxgloveClient
from tests.graph_harness import small_run
from tests.loop_contract import assert_as_the_loop, whole_graph
from tests.stress.supervised_run import SupervisedRun
from tests.supervisor import environment, finished, start_supervisor

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


def _live_view_of(supervisor_id: int) -> psutil.Process:
    (found,) = (
        child
        for child in psutil.Process(supervisor_id).children(recursive=True)
        if "experiment_manager.live.node" in child.cmdline()
    )
    return found


def test_viewers_see_the_run_and_nothing_that_becomes_of_them_changes_it(
    pictures: Path, tmp_path: Path
) -> None:
    port, out = _free_port(), tmp_path / "run"
    # Bags keep pictures of some episodes only; viewers see all. Long enough for them to connect.
    line = small_run(pictures, 1500, "experiment_manager.checkpoint_period_s=0.2")
    with (
        SupervisedRun([*line, "--live", f":{port}"], out) as run,
        FoxgloveClient(port) as stalled,
        FoxgloveClient(port) as viewer,
    ):
        stalled.subscribe(ALL_TOPICS)  # and never reads
        viewer.subscribe(ALL_TOPICS)
        viewer.receive_of_each(ALL_TOPICS, n_messages=3)
        view = _live_view_of(run.process.pid)
        view.suspend()
        place = run.place()
        assert run.wait_until(lambda: run.place() > place, "more episodes")
        view.kill()
        assert run.wait() == 0, run.output()
        assert f"live view: ws://127.0.0.1:{port}" in run.output()
        assert "the live view has ended" in run.output()
        assert "fault" not in run.output()
    assert_as_the_loop(out)
    first, second = (image_array(m) for m in viewer.received["/left/image_raw"][:2])
    assert first.shape == second.shape == (240, 320)
    errors = [json.loads(m)["running_median_error_deg"] for m in viewer.received[f"/{LEARNING}"]]
    assert all(0.0 <= error_deg < 20.0 for error_deg in errors)


def test_a_port_in_use_is_one_error_and_the_run_goes_on(pictures: Path, tmp_path: Path) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = int(taken.getsockname()[1])
        line = [*small_run(pictures, 20), "--live", f":{port}", "--out", str(tmp_path / "run")]
        output = finished(start_supervisor(line))
    assert output.count("the live view has ended: error: live view: cannot listen on") == 1


def _inspect(*arguments: str | Path) -> "subprocess.Popen[str]":
    return subprocess.Popen(
        [sys.executable, "-m", "experiment_manager.commands.inspect_bag", *map(str, arguments)],
        env=environment(),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


def test_a_recorded_bag_is_played_to_the_same_view(tmp_path_factory, pictures) -> None:
    port = _free_port()
    process = _inspect(
        whole_graph(tmp_path_factory, pictures), "--play", "--rate", "1000", "--at", f":{port}"
    )
    with FoxgloveClient(port) as viewer:
        viewer.subscribe(ALL_TOPICS)
        viewer.receive_to_the_end()
    output = finished(process)
    assert f"ws://127.0.0.1:{port}" in output
    assert set(viewer.received) == set(ALL_TOPICS)
