"""Starts the nodes of a run, watches them, and rolls back to the last checkpoint after a fault."""

import re
import signal
import sys
from collections import deque
from collections.abc import Collection, Sequence
from contextlib import nullcontext
from pathlib import Path

from experiment_manager.live.address import Address
from experiment_manager.nodes import MANAGER, NODES
from experiment_manager.run.attempt import goes_on, place_of
from experiment_manager.run.config_file import CONFIG_FILE, read_configuration
from experiment_manager.supervision.domains import NODE_SCRIPTS_DOMAIN, own_domain
from experiment_manager.supervision.live_view import LiveView
from experiment_manager.supervision.network import Network, addresses
from experiment_manager.supervision.node_heartbeats import Heartbeats
from experiment_manager.supervision.processes import (
    NodeProcesses,
    last_words,
)
from lockstep.exit_codes import (
    EXIT_BAD_INPUT,
    EXIT_DIVERGED,
    EXIT_FAULT,
    EXIT_INTERRUPTED,
    EXIT_NETWORK,
    EXIT_UNWRITABLE,
    FAULT_TEXT,
)
from lockstep.files.durable_files import why_unwritable
from lockstep.machine.domain import given_domain
from lockstep.machine.interrupts import Interrupts
from lockstep.node.parameter_files import parameter_arguments

# For nodes elsewhere, in s: a cut shorter than this looks like a hang. Longer than Fast DDS
# goes on to count somebody whom it does not hear, 20 s.
_LEAST_GAP_ELSEWHERE_S = 30.0
_SAME_FAULT_LIMIT = 3
# Faults of different kinds without a checkpoint between them: somebody should look.
_ANY_FAULT_LIMIT = 10
# What is left of killed nodes may linger in their domain: the last ones are not taken again yet.
_N_AVOIDED_DOMAINS = 10
# The same fault may name another time or count.
_NUMBER = re.compile(r"[0-9.]+")


class Supervisor:
    """Brings one run to its end: one attempt after another, each from the newest checkpoint."""

    def __init__(
        self,
        directory: Path,
        elsewhere: Collection[str] = (),
        live: Address | None = None,
    ) -> None:
        """directory: holds config.yaml, and whatever the run has done so far.

        elsewhere: nodes that somebody else starts, in the domain of `known_domain`; what they lack
        of signs of life the manager notices. live: where a live view listens, None for none.
        """
        self._directory = directory
        self._elsewhere = frozenset(elsewhere)
        self._live = live
        self._packages = [package for package in NODES if package not in elsewhere]
        self._processes: NodeProcesses | None = None

    def run(self) -> int:
        """Return the exit code: 0 done, 2 bad input, 3 a fault that stays, 6 one of learning.

        After Ctrl-C it is 130. A fault is a node that dies, hangs or says that the run cannot go
        on.
        """
        self._interrupts = Interrupts(self._interrupt_manager)
        faults: list[tuple[int, str]] = []
        used: deque[int] = deque(maxlen=_N_AVOIDED_DOMAINS)
        known = known_domain(self._elsewhere)
        while True:
            with own_domain(frozenset(used)) if known is None else nullcontext(known) as domain:
                used.append(domain)
                print(f"to listen from another terminal: export ROS_DOMAIN_ID={domain}")
                code, fault = self._attempt(domain)
            if code == EXIT_NETWORK:
                print("the network is back: starting the nodes again", file=sys.stderr)
                continue
            if fault is None:
                return code
            # The bar's line, of another process, may be unfinished.
            print(f"\nfault: {fault}", file=sys.stderr)
            if self._interrupts.count:
                return EXIT_INTERRUPTED
            faults.append((self._place(), _NUMBER.sub("", fault)))
            if error := self._hopeless(faults, fault):
                print(f"error: {error}; logs: {self._directory / 'logs'}", file=sys.stderr)
                return EXIT_FAULT
            print("rolling back to the newest checkpoint", file=sys.stderr)

    def _hopeless(self, faults: Sequence[tuple[int, str]], fault: str) -> str:
        """Return why another attempt would be in vain, or "" when it would not."""
        place, _ = faults[-1]
        where = f"after episode {place}" if place >= 0 else "before the first checkpoint"
        if faults.count(faults[-1]) >= _SAME_FAULT_LIMIT:
            return f"the same fault {_SAME_FAULT_LIMIT} times {where}: {fault}"
        if sum(at == place for at, _ in faults) >= _ANY_FAULT_LIMIT:
            return f"{_ANY_FAULT_LIMIT} faults {where}, the last one: {fault}"
        return ""

    def _place(self) -> int:
        return place_of(self._directory)

    def _attempt(self, domain: int) -> tuple[int, str | None]:
        """Run the nodes until they are done or fail; return (exit code, fault or None)."""
        if self._interrupts.count:
            return EXIT_INTERRUPTED, None
        given: dict[str, object] = {
            "run_directory": str(self._directory),
            "resume": goes_on(self._directory),
            "supervised": True,
        }
        if self._elsewhere:
            configuration = read_configuration(self._directory / CONFIG_FILE)
            given["gap_s"] = max(_LEAST_GAP_ELSEWHERE_S, configuration[MANAGER]["gap_s"])
        more = {MANAGER: parameter_arguments(given)}
        directory, packages, network = self._directory, self._packages, Network(addresses())
        place = self._place()
        with (
            NodeProcesses(directory, domain, more, packages) as processes,
            LiveView(self._live, domain, directory) as live_view,
            Heartbeats(domain, packages) as heartbeats,
        ):
            self._processes = processes
            while not (codes := processes.exit_codes()):
                fault = heartbeats.wait()
                live_view.look()
                if fault:
                    return EXIT_FAULT, fault
                # A manager that has said and saved nothing may hang, and has no episode under way.
                is_silent = MANAGER not in heartbeats.heard and self._place() == place
                if self._interrupts.count > 0 and is_silent:
                    return EXIT_INTERRUPTED, None
                all_began = heartbeats.heard.issuperset(packages)
                met = self._elsewhere <= heartbeats.heard
                if self._elsewhere and network.is_back(addresses(), all_began=all_began, met=met):
                    return EXIT_NETWORK, None
            # Of several that have ended, one that diverged knows best why, and then the manager.
            known = [MANAGER, *(name for name, code in codes.items() if code == EXIT_DIVERGED)]
            name = next((name for name in reversed(known) if name in codes), next(iter(codes)))
            return self._ended(name, codes[name])

    def _ended(self, name: str, code: int) -> tuple[int, str | None]:
        if name == MANAGER and code in (0, EXIT_INTERRUPTED):
            return code, None
        if code < 0:
            return EXIT_FAULT, f"{name} was killed by {signal.Signals(-code).name}"
        last_line = last_words(self._directory / "logs" / f"{name}.log")
        if code == EXIT_BAD_INPUT:
            print(last_line, file=sys.stderr)
            return code, None
        reason = last_line.rpartition(FAULT_TEXT)[2]
        is_unwritable = name == MANAGER and code == EXIT_UNWRITABLE
        if is_unwritable and FAULT_TEXT not in last_line:  # the log could not be written either
            why = why_unwritable(self._directory)
            reason = f"{self._directory} cannot be written{': ' if why else ''}{why}"
        if is_unwritable or code == EXIT_DIVERGED:
            print(f"\nerror: {reason}; what was saved before is intact", file=sys.stderr)
            return (EXIT_FAULT if is_unwritable else EXIT_DIVERGED), None
        return EXIT_FAULT, f"{name} ended: {reason}"

    def _interrupt_manager(self) -> None:
        if self._processes is not None:
            self._processes.interrupt_manager()


def known_domain(elsewhere: Collection[str]) -> int | None:
    """Return the domain in which others expect the run, None when it may be any."""
    given = given_domain()
    return NODE_SCRIPTS_DOMAIN if given is None and elsewhere else given
