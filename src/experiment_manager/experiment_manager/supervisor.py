"""run_experiment.sh: starts the nodes of a run, watches them, and rolls back after a fault."""

import argparse
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Collection, Sequence
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from types import FrameType

from experiment_manager import checkpoint
from experiment_manager.bag_reader import Bag
from experiment_manager.cost_weight import first_iterations, with_weight
from experiment_manager.domains import NODE_SCRIPTS_DOMAIN, given_domain, own_domain
from experiment_manager.durable_files import replace_file, why_unwritable
from experiment_manager.figures import learning_curve
from experiment_manager.heartbeats import Heartbeats
from experiment_manager.lasting_output import make_standard_streams_last
from experiment_manager.neighbours import addresses, refuse_neighbours
from experiment_manager.node import EXIT_INTERRUPTED, EXIT_UNWRITABLE, FAULT_TEXT
from experiment_manager.options import (
    Configuration,
    arguments,
    configuration_of,
    configuration_text,
    read_configuration,
)
from experiment_manager.processes import MANAGER, PACKAGES, NodeProcesses
from experiment_manager.results import read_results
from experiment_manager.run import CONFIG_FILE, RESULTS_FILE
from experiment_manager.shared_memory import remove_ports, remove_stale_segments
from experiment_manager.summary import results_table
from eye_plant.config import EyePlantConfig
from eye_plant.stimuli import load_stimuli
from lockstep.configuration import build
from lockstep.errors import InputError
from lockstep.process import EXIT_BAD_INPUT

EXIT_FAULT = 3
# Of an attempt only: the nodes began without a network that is there now.
EXIT_NETWORK = 5
# For nodes elsewhere, in s: a cut shorter than this is not told from a hang. Longer than Fast DDS
# goes on to count somebody whom it does not hear, 20 s.
_LEAST_GAP_ELSEWHERE_S = 30.0
# A bag's file before its first message: schemas, and the configuration.
_HEADER_BYTES = 1 << 16
_SAME_FAULT_LIMIT = 3
# Faults of different kinds without a checkpoint between them: somebody should look.
_ANY_FAULT_LIMIT = 10
# The same fault may name another time or count.
_NUMBER = re.compile(r"[0-9.]+")


class Supervisor:
    """Brings one run to its end: one attempt after another, each from the newest checkpoint."""

    def __init__(self, directory: Path, elsewhere: Collection[str] = ()) -> None:
        """directory: holds config.yaml, and whatever the run has done so far.

        elsewhere: nodes that somebody else starts, in the domain of `known_domain`. What they lack
        of signs of life the manager notices.
        """
        self._directory = directory
        self._elsewhere = frozenset(elsewhere)
        self._packages = [package for package in PACKAGES if package not in elsewhere]
        self._known_domain = known_domain(elsewhere)
        self._processes: NodeProcesses | None = None
        self._interrupts = 0

    def run(self) -> int:
        """Return the exit code: 0 done, 2 bad input, 3 a fault that stays, 130 Ctrl-C.

        A fault is a node that dies, hangs or says that the run cannot go on.
        """
        signal.signal(signal.SIGINT, self._interrupt)
        signal.signal(signal.SIGTERM, self._interrupt)
        if signal.getsignal(signal.SIGHUP) != signal.SIG_IGN:  # as nohup leaves it
            signal.signal(signal.SIGHUP, self._hang_up)
        faults: list[tuple[int, str]] = []
        used_domains: set[int] = set()
        while True:
            with self._domain(frozenset(used_domains)) as domain:
                used_domains.add(domain)
                print(f"to listen from another terminal: export ROS_DOMAIN_ID={domain}")
                code, fault = self._attempt(domain)
                remove_stale_segments()
                if self._known_domain is None:
                    remove_ports(domain)
            if code == EXIT_NETWORK:
                print("the network is back: starting the nodes again", file=sys.stderr)
                continue
            if fault is None:
                return code
            print(f"fault: {fault}", file=sys.stderr)
            if self._interrupts:
                return EXIT_INTERRUPTED
            faults.append((self._place(), _NUMBER.sub("", fault)))
            if error := self._hopeless(faults, fault):
                print(f"error: {error}; logs: {self._directory / 'logs'}", file=sys.stderr)
                return EXIT_FAULT
            print("rolling back to the newest checkpoint", file=sys.stderr)

    def _domain(self, used: frozenset[int]) -> AbstractContextManager[int]:
        known = self._known_domain
        return own_domain(used) if known is None else nullcontext(known)

    def _gap_s(self) -> float:
        configuration = read_configuration(self._directory / CONFIG_FILE)
        return max(_LEAST_GAP_ELSEWHERE_S, configuration[MANAGER]["gap_s"])

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
        found = checkpoint.newest(self._directory / "checkpoints")
        return found[0].place if found else -1

    def _attempt(self, domain: int) -> tuple[int, str | None]:
        """Run the nodes until they are done or fail; return (exit code, fault or None)."""
        if self._interrupts:
            return EXIT_INTERRUPTED, None
        resume = self._place() >= 0
        if not resume and not _holds_observations(self._directory / "bag"):
            # Left by an attempt that ended before its first episode.
            shutil.rmtree(self._directory / "bag", ignore_errors=True)
        given = {
            "run_directory": self._directory,
            "resume": str(resume).lower(),
            "supervised": "true",
        }
        if self._elsewhere:
            given["gap_s"] = str(self._gap_s())
        more = {MANAGER: [word for k, v in given.items() for word in ("-p", f"{k}:={v}")]}
        config, logs = self._directory / CONFIG_FILE, self._directory / "logs"
        at_start = addresses()
        with (
            NodeProcesses(config, domain, logs, more, self._packages) as processes,
            Heartbeats(domain, self._packages) as heartbeats,
        ):
            self._processes = processes
            while not (codes := processes.exit_codes()):
                silent = heartbeats.wait()
                if silent:
                    return EXIT_FAULT, f"{silent} gives no sign of life"
                if not self._elsewhere <= heartbeats.heard and not addresses() <= at_start:
                    # Who is elsewhere does not know the way to nodes that are older than it.
                    return EXIT_NETWORK, None
            # Of several that have ended, the manager knows best why.
            name = MANAGER if MANAGER in codes else next(iter(codes))
            return self._ended(name, codes[name])

    def _ended(self, name: str, code: int) -> tuple[int, str | None]:
        if name == MANAGER and code in (0, EXIT_INTERRUPTED):
            return code, None
        if code < 0:
            return EXIT_FAULT, f"{name} was killed by {signal.Signals(-code).name}"
        last_line = self._last_line_of_log(name)
        if code == EXIT_BAD_INPUT:
            print(last_line, file=sys.stderr)
            return code, None
        reason = last_line.rpartition(FAULT_TEXT)[2]
        if name == MANAGER and code == EXIT_UNWRITABLE:
            if FAULT_TEXT not in last_line:  # the log could not be written either
                why = why_unwritable(self._directory)
                reason = f"{self._directory} cannot be written{': ' if why else ''}{why}"
            print(f"error: {reason}; what was saved before is whole", file=sys.stderr)
            return EXIT_FAULT, None
        return EXIT_FAULT, f"{name} ended: {reason}"

    def _last_line_of_log(self, name: str) -> str:
        log = self._directory / "logs" / f"{name}.log"
        lines = log.read_text(errors="replace").split("\n")
        return next((line for line in reversed(lines) if line.strip()), "without a word")

    def _interrupt(self, number: int, frame: FrameType | None) -> None:
        self._interrupts += 1
        if self._processes is not None:
            self._processes.interrupt_manager()
        if self._interrupts == 1:
            print("\nstopping after this episode, with a checkpoint", file=sys.stderr)

    def _hang_up(self, number: int, frame: FrameType | None) -> None:
        # A terminal that is closed says so more than once, a person who wants to stop at once not.
        if not self._interrupts:
            self._interrupt(number, frame)


def _holds_observations(bag: Path) -> bool:
    """Return whether a bag, which may be cut off, holds anything of an episode."""
    files = list(bag.glob("*.mcap"))
    try:
        opened = Bag(bag)
        return opened.has("episode") and len(opened.stamps_ns("episode")) > 0
    except InputError:
        # Cut off before anything could be read; what is larger is somebody's to repair.
        return any(file.stat().st_size > _HEADER_BYTES for file in files)


def _source_commit() -> str:
    command = ["git", "-C", str(Path(__file__).parent), "rev-parse", "HEAD"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except OSError:
        return "unknown"
    return done.stdout.strip() or "unknown"


def _prepare_stimuli(configuration: Configuration) -> None:
    """Make the generated stimuli now if they are not in the cache: a node has no time for that."""
    plant = build(EyePlantConfig, configuration["eye_plant"])
    print("preparing the stimuli (the first time, they are generated: about a minute)")
    load_stimuli(plant.stimuli)


def _with_share(configuration: Configuration, share: float) -> Configuration:
    """Return the configuration with the lambda that gives energy this share of the reward."""
    first = first_iterations(configuration)
    weight = first.weight_for(share)
    print(
        f"over the first {first.n_iterations} iterations with lambda 0: mean E "
        f"{first.reconstruction_error:.4f}, mean C {first.metabolic_rate_w:.4f} W; lambda "
        f"{weight:.6g} per W makes lambda C {share:g} of E + lambda C"
    )
    return with_weight(configuration, weight)


def known_domain(elsewhere: Collection[str]) -> int | None:
    """Return the domain in which others expect the run, None when it may be any."""
    given = given_domain()
    return NODE_SCRIPTS_DOMAIN if given is None and elsewhere else given


def _say_how_to_start(nodes: Collection[str], domain: int | None, config: Path) -> None:
    """Tell a person what to do on another machine."""
    reach = os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET")
    for node in nodes:
        print(
            f"{node} is awaited; on its machine, with a copy of {config}:\n"
            f"  ROS_DOMAIN_ID={domain} ROS_AUTOMATIC_DISCOVERY_RANGE={reach} "
            f"launch_scripts/{node}.sh --ros-args --params-file {config.name}"
        )


def _prepare(options: argparse.Namespace) -> Path:
    """Return the run directory that the command line asks for, with its config.yaml."""
    if options.resume is not None:
        directory = Path(options.resume).resolve()
        read_configuration(directory / CONFIG_FILE)
        if why := why_unwritable(directory):
            raise InputError(f"{directory}: cannot be written: {why}")
        return directory
    configuration = configuration_of(options, _source_commit())
    _prepare_stimuli(configuration)
    if options.share is not None:
        configuration = _with_share(configuration, options.share)
    name = time.strftime("%Y%m%d-%H%M%S")
    directory = (options.out or Path("runs") / name).resolve()
    if directory.exists() and (not directory.is_dir() or any(directory.iterdir())):
        raise InputError(
            f"{directory}: expected a new or empty directory, it already holds something; "
            f"--resume {directory} goes on with a run"
        )
    try:
        directory.mkdir(parents=True, exist_ok=True)
        replace_file(directory / CONFIG_FILE, configuration_text(configuration).encode())
    except OSError as error:
        raise InputError(f"{directory}: cannot be written: {error}") from error
    return directory


def _figure(directory: Path) -> Path | None:
    """Draw the learning curve; None when the bag has nothing to draw it from."""
    try:
        return learning_curve(directory)
    except (InputError, OSError) as error:
        print(f"no learning curve: {error}", file=sys.stderr)
        return None


def _how_to_go_on(elsewhere: Sequence[str], directory: Path) -> str:
    nodes = f" --elsewhere {','.join(elsewhere)}" if elsewhere else ""
    return f"launch_scripts/run_experiment.sh --resume {directory}{nodes}"


def main(argv: Sequence[str] | None = None) -> int:
    """Run one experiment; return the exit code."""
    try:
        options = arguments(argv)
        domain = known_domain(options.elsewhere)
        if domain is not None:
            refuse_neighbours(domain, options.elsewhere)
        directory = _prepare(options)
        print(f"run directory: {directory}")
        _say_how_to_start(options.elsewhere, domain, directory / CONFIG_FILE)
        code = Supervisor(directory, options.elsewhere).run()
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        return EXIT_BAD_INPUT
    except KeyboardInterrupt:
        print("stopped before the run began", file=sys.stderr)
        return EXIT_INTERRUPTED
    if code == 0:
        print(results_table(read_results(directory / RESULTS_FILE), directory, _figure(directory)))
    elif code != EXIT_BAD_INPUT:
        print(f"to go on: {_how_to_go_on(options.elsewhere, directory)}", file=sys.stderr)
    return code


if __name__ == "__main__":
    make_standard_streams_last()
    sys.exit(main())
