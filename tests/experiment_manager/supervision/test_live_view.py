"""The process of a live view, which may end as it likes."""

from pathlib import Path

import psutil

from experiment_manager.live.address import Address
from experiment_manager.supervision.domains import own_domain
from experiment_manager.supervision.live_view import LiveView
from tests.graph_harness import small_run, write_configuration
from tests.patience import PATIENCE_S


def test_one_that_was_killed_is_said_once(pictures, tmp_path: Path, capsys) -> None:
    write_configuration(tmp_path / "config.yaml", small_run(pictures))
    (tmp_path / "logs").mkdir()
    address = Address("127.0.0.1", 1)  # it is killed before it listens there
    others = set(psutil.Process().children())
    with own_domain() as domain, LiveView(address, domain, tmp_path) as view:
        (process,) = set(psutil.Process().children()) - others
        view.look()
        assert capsys.readouterr().err == ""
        process.kill()
        psutil.wait_procs([process], timeout=PATIENCE_S)
        view.look()
        view.look()
    said = "the live view has ended: without a word; the run continues\n"
    assert capsys.readouterr().err == said
