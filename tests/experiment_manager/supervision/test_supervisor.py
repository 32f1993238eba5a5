"""What a supervisor does before and after its nodes, without any."""

import signal
from pathlib import Path

import pytest

from active_binocular_vision.commands import run
from experiment_manager.supervision.supervisor import Supervisor
from lockstep.exit_codes import EXIT_DIVERGED, EXIT_NETWORK, EXIT_UNWRITABLE


class Attempts(Supervisor):
    """A supervisor whose attempts end as they are told to."""

    def __init__(self, directory: Path, ends: list[tuple[int, str | None]], places: list[int]):
        super().__init__(directory)
        self.ends, self.places = ends, places
        self.domains: list[int] = []

    @property
    def n_attempts(self) -> int:
        return len(self.domains)

    def _attempt(self, domain: int) -> tuple[int, str | None]:
        self.domains.append(domain)
        return self.ends.pop(0)

    def _place(self) -> int:
        return self.places.pop(0)


@pytest.fixture(autouse=True)
def _own_signals() -> object:
    """Put the signal handlers back; the tests themselves may run under nohup."""
    numbers = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    before = {number: signal.getsignal(number) for number in numbers}
    signal.signal(signal.SIGHUP, signal.SIG_DFL)
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


def test_faults_at_different_places_are_rolled_back(tmp_path: Path) -> None:
    fault = (3, "plant was killed by SIGKILL")
    assert Attempts(tmp_path, [fault] * 5 + [(0, None)], [0, 0, 3, 3, 9]).run() == 0


def test_the_same_fault_three_times_at_one_place(tmp_path, capsys) -> None:
    # Numbers in the text may differ: what is missing is never the same twice.
    ends: list[tuple[int, str | None]] = [(3, f"missing: {i} of reward") for i in range(4)]
    attempts = Attempts(tmp_path, ends, [7, 7, 7])
    assert attempts.run() == 3
    assert attempts.n_attempts == 3
    error = capsys.readouterr().err
    assert error.count("error: ") == 1
    assert "error: the same fault 3 times after episode 7: missing: 2 of reward; logs: " in error


def test_many_different_faults_at_one_place(tmp_path, capsys) -> None:
    ends: list[tuple[int, str | None]] = [(3, f"fault {letter}") for letter in "abcdefghijk"]
    attempts = Attempts(tmp_path, ends, [-1] * 11)
    assert attempts.run() == 3
    assert attempts.n_attempts == 10
    assert "10 faults before the first checkpoint, the last one: fault j" in capsys.readouterr().err


def test_after_ctrl_c_a_fault_is_not_rolled_back(tmp_path: Path) -> None:
    class Interrupted(Attempts):
        def _attempt(self, domain: int) -> tuple[int, str | None]:
            signal.raise_signal(signal.SIGINT)
            return super()._attempt(domain)

    attempts = Interrupted(tmp_path, [(3, "died of it"), (0, None)], [0])
    assert attempts.run() == 130
    assert attempts.n_attempts == 1


def test_a_terminal_hangs_up_once_however_often_it_says_so(tmp_path: Path) -> None:
    class HungUp(Attempts):
        def _attempt(self, domain: int) -> tuple[int, str | None]:
            signal.raise_signal(signal.SIGHUP)
            signal.raise_signal(signal.SIGHUP)
            return 100 + self._interrupts.count, None

    assert HungUp(tmp_path, [], []).run() == 101
    # Who starts it with nohup wants it to go on.
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    assert HungUp(tmp_path, [], []).run() == 100


def test_nodes_that_began_without_a_network_are_no_fault(tmp_path, capsys) -> None:
    # More often than there are domains; each time one that was not used a moment ago.
    ends: list[tuple[int, str | None]] = [*[(EXIT_NETWORK, None)] * 110, (0, None)]
    attempts = Attempts(tmp_path, ends, [])
    assert attempts.run() == 0
    assert capsys.readouterr().err.count("the network is back") == 110
    assert all(len(set(attempts.domains[i : i + 10])) == 10 for i in range(101))


def test_a_disk_that_refuses_is_said_once_and_not_tried_again(tmp_path, capsys) -> None:
    (tmp_path / "logs").mkdir()
    log = tmp_path / "logs" / "experiment_manager.log"
    log.write_text("[ERROR] [1.5] [n]: the run cannot continue: no space\n")
    ended = Supervisor(tmp_path)._ended("experiment_manager", EXIT_UNWRITABLE)
    assert ended == (3, None)
    # The log may lie on the same disk.
    log.write_text("[INFO] [1.5] [n]: all is well\n")
    Supervisor(tmp_path)._ended("experiment_manager", EXIT_UNWRITABLE)
    first, second = filter(None, capsys.readouterr().err.splitlines())
    assert first == "error: no space; what was saved before is intact"
    assert second == f"error: {tmp_path} cannot be written; what was saved before is intact"


def test_learning_that_ran_away_would_do_so_again(tmp_path, capsys) -> None:
    (tmp_path / "logs").mkdir()
    (tmp_path / "logs" / "vergence_rl.log").write_text("the run cannot continue: it diverged\n")
    assert Supervisor(tmp_path)._ended("vergence_rl", EXIT_DIVERGED) == (EXIT_DIVERGED, None)
    error = "\nerror: it diverged; what was saved before is intact\n"
    assert capsys.readouterr().err == error


def test_bad_input_is_not_tried_again(tmp_path: Path) -> None:
    assert Attempts(tmp_path, [(2, None)], []).run() == 2


@pytest.mark.parametrize(
    ("log", "expected"),
    [
        ("a\nTraceback\nValueError: x\n", "coder ended: ValueError: x"),
        ("[ERROR] [1.5] [n]: the run cannot continue: no disk\n\n", "coder ended: no disk"),
        ("", "coder ended: without a word"),
    ],
)
def test_the_reason_is_the_last_line_of_the_log(tmp_path: Path, log: str, expected: str) -> None:
    (tmp_path / "logs").mkdir()
    (tmp_path / "logs" / "coder.log").write_text(log)
    assert Supervisor(tmp_path)._ended("coder", 1) == (3, expected)


def test_ctrl_c_before_the_run_begins(tmp_path, monkeypatch, capsys) -> None:
    def interrupted(argv: object) -> Path:
        raise KeyboardInterrupt

    monkeypatch.setattr(run, "prepare", interrupted)
    assert run.main([]) == 130
    assert "Traceback" not in capsys.readouterr().err
