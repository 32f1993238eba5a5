"""torture.sh: the long tests of reliability, and their figures."""

import argparse
import dataclasses
import json
import shutil
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from experiment_manager.preparation.command_line import arguments, request_of
from experiment_manager.preparation.configuration import configuration_of
from experiment_manager.run.config_file import configuration_text
from experiment_manager.supervision.processes import PACKAGES
from lockstep.errors import InputError
from lockstep.exit_codes import EXIT_BAD_INPUT
from lockstep.wire.qos import QUEUE_DEPTH
from tests.stress.clock_jumps import jump
from tests.stress.cuts import cut
from tests.stress.fuzzed_graph import FuzzedGraph, FuzzReport, memory_mb
from tests.stress.fuzzer import LARGEST_BYTES
from tests.stress.hard_starts import kill_starts, limit_memory
from tests.stress.smallest_failing_input import smallest
from tests.stress.supervised_run import (
    SupervisedRun,
    are_gone,
    n_messages,
    problems_of,
    stamp_faults,
    undisturbed,
)
from tests.stress.totals import Totals

_SETTINGS = (
    "eye_plant.stimuli.size_px=64",
    "eye_plant.stimuli.n_training=3",
    "eye_plant.stimuli.n_test=1",
    "experiment_manager.protocol.test_distances_m=[1.0]",
    "experiment_manager.protocol.least_start_error_deg=0",
)
_SMALL_LEARNERS = ("sparse_coder.n_bases=32", "vergence_rl.n_features=64")
_OFTEN = ("experiment_manager.checkpoint_period_s=1.0",)
_N_DISTURBED_ITERATIONS = 2000
_EPISODES_PER_PASS = 40
_INPUTS_PER_OBSERVATION = 20
# Longest time from one disturbance to the next: starting, catching up and working all get some.
_LONGEST_PAUSE_S = 12.0
_MOST_AT_PLACE = 2
_SAMPLE_PERIOD_S = 2.0
# A message or a trial that were kept, of 356,000 and 7,800, would show.
_SOAK_GROWTH_LIMIT_MB = 8.0
_SUPERVISOR = "supervisor"
_MOST_TOLD = 5
# Of each part, the figure that counts what is done, and how much of it one slice does.
_COUNTS = {
    "kills": "disturbances",
    "hostile input": "inputs",
    "cuts": "cuts",
    "clock jumps": "jumps",
    "soak": "iterations",
    "start kills": "disturbances",
    "memory limits": "disturbances",
}
_SLICES = {
    "kills": 25,
    "hostile input": 10_000,
    "cuts": 6,
    "clock jumps": 25,
    "soak": 200_000,
    "start kills": 10,
    "memory limits": 10,
}


@dataclasses.dataclass(frozen=True)
class Outcome:
    """What one part of the torture has measured; problems: empty when all held."""

    name: str
    figures: dict[str, Any]
    problems: list[str]


def _line(n_iterations: int, *settings: str) -> list[str]:
    words = ["--profile", "paper", "--iterations", str(n_iterations), "--tests", "0"]
    for setting in (*_SETTINGS, *settings):
        words += ["--set", setting]
    return words


def _disturbed_line() -> list[str]:
    return _line(_N_DISTURBED_ITERATIONS, *_SMALL_LEARNERS, *_OFTEN)


def disturb(directory: Path, n_kills: int, draw: np.random.Generator) -> Outcome:
    """Kill or stop nodes, and sometimes the supervisor, until n_kills; compare the numbers."""
    line = _disturbed_line()
    reference = undisturbed(line, directory / "undisturbed")
    done: Counter[str] = Counter()
    problems: list[str] = []
    n_runs = 0
    while done.total() < n_kills and not problems:
        disturbed = directory / f"disturbed_{n_runs}"
        ended = _disturbed_run(line, disturbed, n_kills, draw, done)
        n_runs += 1
        problems += problems_of(disturbed, reference, *ended)
        print(f"run {n_runs}: {done.total()} of {n_kills} disturbances, {problems or 'all held'}")
    figures = {
        "disturbances": done.total(),
        "by_kind": dict(sorted(done.items())),
        "runs": n_runs,
        "messages_compared": n_runs * n_messages(reference),
    }
    return Outcome("kills", figures, problems)


def _disturbed_run(
    line: Sequence[str],
    directory: Path,
    n_kills: int,
    draw: np.random.Generator,
    done: Counter[str],
) -> tuple[int, str]:
    """Make one run under disturbances; return its exit code and what it said."""
    resume, at_place = False, Counter[int]()
    while True:
        with SupervisedRun(line, directory, resume=resume) as run:
            while True:
                run.pause(float(draw.uniform(0.0, _LONGEST_PAUSE_S)))
                if run.process.poll() is not None:
                    return run.process.returncode, run.output()
                if done.total() >= n_kills:
                    return run.wait(), run.output()
                what = _disturb_once(run, draw, at_place)
                done.update([what] if what else [])
                if what.startswith(_SUPERVISOR):
                    break
            # Its nodes die with it, whatever they were doing; then a person resumes the run.
            resume = True


def _disturb_once(run: SupervisedRun, draw: np.random.Generator, at_place: Counter[int]) -> str:
    """Kill or stop somebody; return what was done, "" when it could not be.

    at_place: disturbances since each checkpoint. A third one might look like the first two, and
    that ends a run, as it should.
    """
    place = run.place()
    if draw.random() < 0.1 and place >= 0:
        at_place[place] += 1
        nodes = run.nodes().values()
        run.process.kill()
        run.process.wait()
        if not are_gone(nodes):
            raise RuntimeError(f"nodes outlive their supervisor: {nodes}")
        return f"{_SUPERVISOR} killed"
    package = PACKAGES[int(draw.integers(len(PACKAGES)))]
    number = signal.SIGSTOP if draw.random() < 0.2 else signal.SIGKILL
    if place < 0 or at_place[place]:
        # Perhaps it is still starting. To find out that it hangs would take two minutes.
        number = signal.SIGKILL
    if at_place[place] >= _MOST_AT_PLACE or not run.signal_node(package, number):
        return ""
    at_place[place] += 1
    verb = "stopped" if number == signal.SIGSTOP else "killed"
    return f"{package} {verb}"


def fuzz(directory: Path, n_inputs: int, seed: int) -> Outcome:
    """Send hostile input to the nodes, n_inputs in all; compare the numbers."""
    directory = directory / "fuzzed"
    directory.mkdir(parents=True, exist_ok=True)
    config_file = directory / "config.yaml"
    line = _line(_N_DISTURBED_ITERATIONS, *_SMALL_LEARNERS)
    config_file.write_text(configuration_text(configuration_of(request_of(arguments(line)), "")))
    figures: dict[str, Any] = {"inputs": 0, "refused": 0, "numbers_compared": 0, "growth_mb": 0.0}
    problems: list[str] = []
    bound_mb = 4 * QUEUE_DEPTH * LARGEST_BYTES / 2**20
    n_passes = 0
    while figures["inputs"] < n_inputs and not problems:
        logs = directory / f"pass_{n_passes}"
        logs.mkdir()
        report = FuzzedGraph(config_file, seed + n_passes).run(
            _EPISODES_PER_PASS, _INPUTS_PER_OBSERVATION, logs
        )
        n_passes += 1
        figures["inputs"] += report.n_inputs
        figures["refused"] += report.n_refused
        figures["numbers_compared"] += report.n_compared
        figures["growth_mb"] = round(max(figures["growth_mb"], *report.growth_mb.values()), 1)
        if report.differences:
            problems += _smallest_case(config_file, seed + n_passes - 1, report, directory)
        if figures["growth_mb"] > bound_mb:
            problems.append(f"memory grew by {figures['growth_mb']} MB, expected {bound_mb:.0f}")
        print(
            f"pass {n_passes}: {figures['inputs']} of {n_inputs} inputs, {problems or 'all held'}"
        )
    return Outcome("hostile input", figures, problems)


def _smallest_case(config_file: Path, seed: int, report: FuzzReport, directory: Path) -> list[str]:
    """Return what differed, and the fewest inputs of the pass that still make a difference."""
    n_tries = 0
    told: list[str] = []

    def bites(kept: Sequence[int]) -> bool:
        nonlocal n_tries, told
        logs = directory / f"seed_{seed}_try_{n_tries}"
        logs.mkdir()
        n_tries += 1
        tried = FuzzedGraph(config_file, seed).run(
            _EPISODES_PER_PASS, _INPUTS_PER_OBSERVATION, logs, kept=frozenset(kept)
        )
        told = tried.told if tried.differences else told
        return bool(tried.differences)

    smallest(range(report.n_inputs), bites)
    return [*report.differences[:_MOST_TOLD], f"the fewest inputs of seed {seed}:", *told]


def soak(directory: Path, n_iterations: int, seed: int) -> Outcome:
    """Make one long run as the paper has it, tests included; look at its memory and its stamps."""
    line = ["--profile", "paper", "--iterations", str(n_iterations), "--seed", str(seed)]
    samples: dict[str, list[float]] = {package: [] for package in PACKAGES}
    began_s = time.monotonic()
    with SupervisedRun(line, directory / "soak") as run:
        while run.process.poll() is None:
            for package, process_id in run.nodes().items():
                try:
                    samples[package].append(memory_mb(process_id))
                except (FileNotFoundError, ProcessLookupError):
                    continue
            run.pause(_SAMPLE_PERIOD_S)
        code, output = run.process.returncode, run.output()
    if code != 0:
        return Outcome("soak", {}, [f"the run ended with exit code {code}:\n{output}"])
    growth_mb = {package: round(_growth_mb(values), 1) for package, values in samples.items()}
    problems = stamp_faults(directory / "soak")
    problems += [
        f"{package} grew by {mb} MB from the second quarter of the run to the last"
        for package, mb in growth_mb.items()
        if mb > _SOAK_GROWTH_LIMIT_MB
    ]
    if "fault: " in output:
        problems.append(f"faults during the soak:\n{output}")
    figures = {
        "iterations": n_iterations,
        "messages": n_messages(directory / "soak"),
        "duration_s": round(time.monotonic() - began_s),
        "peak_mb": {package: round(max(values), 1) for package, values in samples.items()},
        "growth_mb": growth_mb,
    }
    return Outcome("soak", figures, problems)


def _growth_mb(samples: Sequence[float]) -> float:
    """Return how much more memory the last quarter of the samples has than the second one."""
    quarter = len(samples) // 4
    if quarter < 1:
        return 0.0
    return float(np.median(samples[-quarter:]) - np.median(samples[quarter : 2 * quarter]))


def _outcome(name: str, part: Callable[[], Outcome]) -> Outcome:
    """Return what a part has measured; one that cannot go on keeps nobody from the others."""
    try:
        return part()
    except (InputError, OSError, RuntimeError) as error:  # a TimeoutError is an OSError
        return Outcome(name, {}, [f"{type(error).__name__}: {error}"])


# How much of each part is done unless the command line says otherwise, in the order of _PARTS.
_AMOUNTS = {
    "kills": (40, "nodes to kill"),
    "inputs": (30_000, "hostile inputs"),
    "cuts": (0, "cuts; needs root"),
    "jumps": (0, "clock jumps"),
    "soak": (200_000, "iterations of a long run"),
    "start kills": (10, "kills of starting nodes"),
    "memory limits": (10, "memory limits"),
}


def _parser() -> argparse.ArgumentParser:
    line = argparse.ArgumentParser(
        prog="torture.sh", description="Run the long tests of reliability."
    )
    for name, (default, text) in _AMOUNTS.items():
        line.add_argument(
            f"--{name.replace(' ', '-')}",
            type=int,
            default=default,
            metavar="N",
            help=f"{text} (default {default})",
        )
    line.add_argument("--seed", type=int, default=1, metavar="S", help="of all random draws")
    line.add_argument(
        "--totals",
        type=Path,
        metavar="FILE",
        help="add up the totals of all slices in FILE, and continue from them",
    )
    line.add_argument("--out", type=Path, metavar="DIR", help="keep the runs in DIR")
    return line


Part = Callable[[Path, int, np.random.Generator, int], Outcome]


_PARTS: dict[str, Part] = {
    "kills": lambda directory, n, draw, seed: disturb(directory, n, draw),
    "hostile input": lambda directory, n, draw, seed: fuzz(directory, n, seed),
    "cuts": lambda directory, n, draw, seed: Outcome(
        "cuts", *cut(_disturbed_line(), directory, n, draw)
    ),
    "clock jumps": lambda directory, n, draw, seed: Outcome(
        "clock jumps", *jump(_disturbed_line(), directory, n, draw)
    ),
    "soak": lambda directory, n, draw, seed: soak(directory, n, seed),
    "start kills": lambda directory, n, draw, seed: Outcome(
        "start kills", *kill_starts(_disturbed_line(), directory, n, draw)
    ),
    "memory limits": lambda directory, n, draw, seed: Outcome(
        "memory limits", *limit_memory(_disturbed_line(), directory, n, draw)
    ),
}


def _slice(name: str, n: int, totals: Totals, options: argparse.Namespace) -> None:
    """Make the next slice of a part, with a seed of its own, and add it to the totals."""
    n_slices = totals.of(name).n_slices
    seeds = np.random.SeedSequence((options.seed, [*_PARTS].index(name), n_slices))
    seed = int(seeds.generate_state(1)[0])
    with tempfile.TemporaryDirectory(prefix="torture_") as temporary:
        directory = (
            Path(options.out or temporary).resolve() / f"{name.replace(' ', '_')}_{n_slices}"
        )
        shutil.rmtree(directory, ignore_errors=True)  # of a slice that was broken off
        directory.mkdir(parents=True)
        part = partial(_PARTS[name], directory, n, np.random.default_rng(seeds), seed)
        outcome = _outcome(name, part)
    n_done = outcome.figures.get(_COUNTS[name], 0)
    totals.add(name, n_done, outcome.figures, outcome.problems)
    print(f"{name}: {totals.of(name).n_done} done, {outcome.problems or 'all held'}", flush=True)


def _left(wanted: Mapping[str, int], totals: Totals) -> dict[str, int]:
    """Return how much is left to do of each part; nothing of one that has failed."""
    left = {name: n - totals.of(name).n_done for name, n in wanted.items() if n}
    return {name: n for name, n in left.items() if n > 0 and not totals.of(name).problems}


def main(argv: Sequence[str] | None = None) -> int:
    """Run the parts asked for, slice by slice; return 0 when all held."""
    options = _parser().parse_args(argv)
    amounts = [getattr(options, name.replace(" ", "_")) for name in _AMOUNTS]
    wanted = dict(zip(_PARTS, amounts, strict=True))
    try:
        totals = Totals(options.totals, options.seed)
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        return EXIT_BAD_INPUT
    # By turns, so that each part has been tried early.
    while left := _left(wanted, totals):
        for name, n in left.items():
            _slice(name, min(n, _SLICES[name]), totals, options)
    for name, part in totals.parts.items():
        print(f"{name}: {json.dumps(part.figures)}")
        for problem in part.problems:
            print(f"{name}: FAILED: {problem}", file=sys.stderr)
    return int(any(part.problems for part in totals.parts.values()))


if __name__ == "__main__":
    sys.exit(main())
