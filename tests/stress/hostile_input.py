"""Hostile input by the thousand, and the fewest of it that change a number, if any do."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from experiment_manager.run.config_file import configuration_text
from lockstep.wire.qos import QUEUE_DEPTH
from tests.command_lines import configured
from tests.stress.disturbed_runs import LINE, Found
from tests.stress.fuzzed_graph import FuzzedGraph, FuzzReport
from tests.stress.fuzzer import LARGEST_BYTES

_EPISODES_PER_PASS = 40
_INPUTS_PER_OBSERVATION = 20
_MOST_SHOWN = 5


def fuzz(directory: Path, n_inputs: int, seeds: np.random.SeedSequence) -> Found:
    """Send hostile input to the nodes, n_inputs in all; compare the numbers."""
    config_file = directory / "config.yaml"
    config_file.write_text(configuration_text(configured(*LINE)))
    seed = int(seeds.generate_state(1)[0])
    figures: dict[str, Any] = {"inputs": 0, "refused": 0, "numbers_compared": 0, "growth_mb": 0.0}
    problems: list[str] = []
    bound_mb = 4 * QUEUE_DEPTH * LARGEST_BYTES / 2**20
    while figures["inputs"] < n_inputs and not problems:
        report = _pass(config_file, seed, directory / f"seed_{seed}")
        figures["inputs"] += report.n_inputs
        figures["refused"] += report.n_refused
        figures["numbers_compared"] += report.n_compared
        figures["growth_mb"] = round(max(figures["growth_mb"], *report.growth_mb.values()), 1)
        if report.differences:
            problems += _smallest_case(config_file, seed, report, directory)
        if figures["growth_mb"] > bound_mb:
            problems.append(f"memory grew by {figures['growth_mb']} MB, expected {bound_mb:.0f}")
        print(f"{figures['inputs']} of {n_inputs} inputs, {problems or 'all held'}")
        seed += 1
    return figures, problems


def _pass(
    config_file: Path, seed: int, logs: Path, kept: frozenset[int] | None = None
) -> FuzzReport:
    logs.mkdir()
    return FuzzedGraph(config_file, seed).run(
        _EPISODES_PER_PASS, _INPUTS_PER_OBSERVATION, logs, kept
    )


def _smallest_case(config_file: Path, seed: int, report: FuzzReport, directory: Path) -> list[str]:
    """Return what differed, and the fewest inputs of the pass that still make a difference."""
    harmful: list[FuzzReport] = []
    n_tries = 0

    def bites(kept: Sequence[int]) -> bool:
        nonlocal n_tries
        n_tries += 1
        tried = _pass(config_file, seed, directory / f"seed_{seed}_try_{n_tries}", frozenset(kept))
        harmful.extend([tried] if tried.differences else [])
        return bool(tried.differences)

    smallest(range(report.n_inputs), bites)
    shown = harmful[-1].shown if harmful else []
    return [*report.differences[:_MOST_SHOWN], f"the fewest inputs of seed {seed}:", *shown]


def smallest(inputs: Sequence[int], bites: Callable[[Sequence[int]], bool]) -> list[int]:
    """Return inputs of which none can be left out, by delta debugging (Zeller, Hildebrandt 2002).

    inputs: which bite together; bites: whether some of them, in their order, still do.
    """
    kept, n_parts = list(inputs), 2
    while len(kept) > 1:
        size = -(-len(kept) // n_parts)
        parts = [kept[start : start + size] for start in range(0, len(kept), size)]
        rests = [[i for i in kept if i not in set(part)] for part in parts]
        # With two parts each rest is the other part.
        candidates = rests if n_parts == 2 else [*parts, *rests]
        found = next((some for some in candidates if bites(some)), None)
        if found is not None:
            n_parts = 2 if found in parts else max(n_parts - 1, 2)
            kept = found
        elif n_parts >= len(kept):
            break
        else:
            n_parts = min(2 * n_parts, len(kept))
    return kept
