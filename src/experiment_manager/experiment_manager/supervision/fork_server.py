"""Where nodes come from: a process that has imported what they need, and forks one when asked.

Imports take a node seconds, a fork takes milliseconds. The fork server is itself forked, from a
process that has imported most of it and has no threads yet: only the thread that forks would go on.

multiprocessing's own fork server begins as a new interpreter, which imports everything again (0.2 s
become 2.5 s or more), and outlives a parent that is killed, with all that it has started.
"""

import contextlib
import importlib
import json
import os
import selectors
import signal
import socket
import sys
import time
import traceback
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from typing import IO

from experiment_manager.terminal.progress_bar import TERMINAL_VARIABLE
from lockstep.machine.own_process import appear_as, die_with

_MAX_MESSAGE_BYTES = 1 << 16
_POLL_S = 0.02
_GONE = "the process that starts the nodes has ended"


class ForkServer:
    """Starts nodes and reports how they ended. All of them die with it, and it with its parent.

    codes: how nodes have ended, as far as that has been heard, by process id.
    """

    def __init__(self, packages: Sequence[str]) -> None:
        """packages: whose nodes will be asked for; it forks when it is entered."""
        self._packages = packages
        self.codes: dict[int, int] = {}

    def __enter__(self) -> "ForkServer":
        """Fork; the nodes are imported while the caller goes on."""
        self._channel, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        parent = os.getpid()
        for stream in (sys.stdout, sys.stderr):
            stream.flush()
        self._process_id = os.fork()
        if self._process_id == 0:
            self._channel.close()
            os._exit(_exit_code(lambda: _serve(theirs, parent, self._packages)))
        theirs.close()
        return self

    def __exit__(self, *exception: object) -> None:
        """End it, and with it all nodes that still live."""
        self._channel.close()
        os.kill(self._process_id, signal.SIGKILL)
        os.waitpid(self._process_id, 0)

    def start(
        self, package: str, arguments: Sequence[str], domain: int, log: IO[bytes]
    ) -> "NodeProcess":
        """Start the node of a package, that is, its module `node`.

        domain: its ROS_DOMAIN_ID; log: where its output goes. What is this process' standard error
        it finds under the number in TERMINAL_VARIABLE. Raises ConnectionError when the fork server
        has ended.
        """
        asked = json.dumps([package, [*arguments], domain]).encode()
        try:
            socket.send_fds(self._channel, [asked], [log.fileno()])
        except ConnectionError as error:
            raise ConnectionError(_GONE) from error
        while (process_id := self._hear()) is None:
            pass
        return NodeProcess(self, process_id)

    def exit_code(self, process_id: int) -> int | None:
        """Return how a node has ended, by a signal as its negative; None while it lives."""
        try:
            while True:
                self._hear(socket.MSG_DONTWAIT)
        except BlockingIOError:
            return self.codes.get(process_id)
        except ConnectionError:
            return self.codes.get(process_id, -signal.SIGKILL)

    def _hear(self, flags: int = 0) -> int | None:
        """Take one message; return the process id if it says that a node has started."""
        message = self._channel.recv(_MAX_MESSAGE_BYTES, flags)
        if not message:
            raise ConnectionError(_GONE)
        process_id, code = json.loads(message)
        if code is None:
            return int(process_id)
        self.codes[process_id] = code
        return None


@dataclass(frozen=True)
class NodeProcess:
    """A node that a fork server has started."""

    fork_server: ForkServer
    process_id: int

    def exit_code(self) -> int | None:
        """Return how it has ended, by a signal as its negative; None while it lives."""
        return self.fork_server.exit_code(self.process_id)

    def signal(self, number: signal.Signals) -> None:
        """Send it a signal, unless it is known to have ended. May be called in a signal handler."""
        if self.process_id not in self.fork_server.codes:
            with contextlib.suppress(ProcessLookupError):
                os.kill(self.process_id, number)


def stop(processes: Collection[NodeProcess], patience_s: float = 3.0) -> None:
    """Ask each to end, and kill those that do not, stopped ones among them."""
    end_s = time.monotonic() + patience_s
    for process in processes:
        process.signal(signal.SIGTERM)
    while any(process.exit_code() is None for process in processes):
        if time.monotonic() > end_s:
            for process in processes:
                process.signal(signal.SIGKILL)
        time.sleep(_POLL_S)


def _exit_code(run: Callable[[], None]) -> int:
    """Do all that a forked process is to do; return with which code it ends."""
    code: object = 0
    try:
        run()
    except SystemExit as end:
        code = end.code
    except BaseException:
        traceback.print_exc()
        code = 1
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError):
            stream.flush()
    return code if isinstance(code, int) else 0


# In the fork server


def _serve(channel: socket.socket, parent: int, packages: Sequence[str]) -> None:
    """Start what is asked for and report what ends, until no more requests."""
    os.setsid()  # Ctrl-C in the terminal is for the supervisor alone
    die_with(parent)
    for package in packages:
        # Where this fails, it fails in the node too, whose log has the reason.
        with contextlib.suppress(Exception):
            importlib.import_module(f"{package}.node")
    woken, wake = os.pipe2(os.O_NONBLOCK | os.O_CLOEXEC)
    signal.signal(signal.SIGCHLD, lambda number, frame: None)
    signal.set_wakeup_fd(wake)
    with selectors.DefaultSelector() as selector, contextlib.suppress(ConnectionError):
        selector.register(channel, selectors.EVENT_READ)
        selector.register(woken, selectors.EVENT_READ)
        while True:
            ready = {key.fileobj for key, _ in selector.select()}
            if woken in ready:
                os.read(woken, _MAX_MESSAGE_BYTES)
                _report_ended(channel)
            if channel in ready:
                _start_one(channel)


def _report_ended(channel: socket.socket) -> None:
    with contextlib.suppress(ChildProcessError):
        while (ended := os.waitpid(-1, os.WNOHANG)) != (0, 0):
            process_id, status = ended
            channel.send(json.dumps([process_id, os.waitstatus_to_exitcode(status)]).encode())


def _start_one(channel: socket.socket) -> None:
    """Fork a node as the next message wants it; raises ConnectionError when there is none."""
    message, logs, _, _ = socket.recv_fds(channel, _MAX_MESSAGE_BYTES, 1)
    if not message:
        raise ConnectionError("no more requests")
    package, arguments, domain = json.loads(message)
    (log,) = logs
    fork_server = os.getpid()
    process_id = os.fork()
    if process_id == 0:
        channel.close()
        os._exit(_exit_code(lambda: _be_node(fork_server, package, arguments, domain, log)))
    os.close(log)
    channel.send(json.dumps([process_id, None]).encode())


# In a node


def _be_node(
    fork_server: int, package: str, arguments: Sequence[str], domain: int, log: int
) -> None:
    """Do what `python -m package.node arguments` does, in a session of its own."""
    os.setsid()
    die_with(fork_server)
    signal.set_wakeup_fd(-1)
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    os.environ["ROS_DOMAIN_ID"] = str(domain)
    os.environ[TERMINAL_VARIABLE] = str(os.dup(2))
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    for number in (1, 2):
        os.dup2(log, number)
    sys.stdout, sys.stderr = (os.fdopen(i, "w", buffering=1, closefd=False) for i in (1, 2))
    module = f"{package}.node"
    appear_as(package.rpartition(".")[2], ["python", "-m", module, *arguments])
    sys.argv = [module, *arguments]
    importlib.import_module(module).main()
