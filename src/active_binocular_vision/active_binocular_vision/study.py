"""Runs from Python: make one, compare several, examine what one has learned."""

import contextlib
import sys
import threading
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from msgspec import to_builtins

from active_binocular_vision.commands.run import check_old, prepare_new, source_commit
from active_binocular_vision.environments.one_thread import OneThread
from active_binocular_vision.examinations.contract.examination import Examination, Findings
from active_binocular_vision.examinations.registry import EXAMINATIONS
from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.shown import Shown
from active_binocular_vision.runs.run import Run
from experiment_manager import RunRequest, Summary
from experiment_manager.preparation.continuation import branch as begun_from
from experiment_manager.preparation.request import OPTIONS
from experiment_manager.run.attempt import goes_on
from experiment_manager.run.config_file import CONFIG_FILE, read_configuration
from experiment_manager.run.in_process import InProcessRun
from experiment_manager.run.run_directory import new_directory
from experiment_manager.sections import by_key
from eye_plant import Head
from eye_plant.head.plant import settings_of
from lockstep import InputError, build
from lockstep.machine.interrupts import Interrupts
from lockstep.written.nearest import unknown

if TYPE_CHECKING:
    import pandas

# What differs between runs without being a setting that somebody chose.
_NOT_COMPARED = ("seed", "commit", "profile", "model", "run_id", "run_directory")
_ARGUMENTS = ("settings", "seed", "out", "on_test", "resume", "branch", "head")


@OneThread()
def run(
    profile: str | None = None,
    *,
    settings: Mapping[str, Any] | None = None,
    seed: int | None = None,
    out: str | Path | None = None,
    on_test: Callable[[Summary], object] | None = None,
    resume: bool = False,
    branch: str | Path | None = None,
    head: Head | None = None,
    **options: Any,
) -> Run:
    """Train and test in this process, as `abv run --in-process` does, with the same numbers.

    profile: by name, default as on the command line; settings: {"SECTION.NAME": value}, as --set;
    out: run directory, default below runs/; on_test: called after each test with its measures, and
    what it raises ends the run; resume: go on with a run that has begun in `out`, and return one
    that has ended; branch: a run, its checkpoint or the name of trained eyes to go on from, as
    --branch; head: a robot's head in the place of the eyes, whose settings are taken over;
    options: as --model, --iterations, --stimuli, --tests, --test-stimuli,
    --control, --schedule-delay and, as metabolic_cost_weight, --lambda, with _ for -.

    Raises InputError for what cannot be run, DivergenceError where learning diverges,
    KeyboardInterrupt after Ctrl-C, with a checkpoint. Another process may make another run.

    Example:
        >>> import active_binocular_vision as abv
        >>> settings = {"eye_plant.stimuli.size_px": 64, "task.n_bases": 32}
        >>> settings["experiment_manager.test_distances_m"] = [2.0]
        >>> options = {"stimuli": "photos", "iterations": 20, "tests": [20], "seed": 2}
        >>> run = abv.run("precise", settings=settings, out="runs/second", **options)
        >>> run.results.index.tolist()
        [20]
        >>> abv.compare([run, "runs/first"])["seed"].tolist()
        [2, 1]
    """
    settings = (settings_of(head) if head else {}) | dict(settings or {})
    for name in options:
        if name not in OPTIONS:
            raise InputError(f"options of abv.run: {unknown(name, [*_ARGUMENTS, *OPTIONS])}")
    options = {n: tuple(v) if isinstance(v, list) else v for n, v in options.items()}
    if options.get("stimuli"):
        options["stimuli"] = str(Path(options["stimuli"]).resolve())
    request = RunRequest(profile=profile, seed=seed, overrides=settings, **options)
    directory = (new_directory() if out is None else Path(out)).resolve()
    if resume and (directory / CONFIG_FILE).exists():
        check_old(directory, request)
    else:
        with contextlib.redirect_stdout(sys.stderr):
            begins = None if branch is None else begun_from(str(branch), request, source_commit())
            prepare_new(request, directory, begins, has_head=head is not None)
    if not _is_over(directory, on_test, head):
        raise KeyboardInterrupt
    return Run(directory)


def _is_over(
    directory: Path, on_test: Callable[[Summary], object] | None, head: Head | None
) -> bool:
    """Bring a run to its end; return whether it came there, or was interrupted before."""
    # Signals come to the main thread alone.
    interrupts = Interrupts(listens=threading.current_thread() is threading.main_thread())
    try:
        process = InProcessRun(
            read_configuration(directory / CONFIG_FILE),
            directory,
            interrupts,
            resume=goes_on(directory),
            on_test=on_test,
            head=head,
        )
        with contextlib.closing(process):
            return process.go_on()
    finally:
        interrupts.stop()


def compare(runs: Iterable[Run | str | Path]) -> "pandas.DataFrame":
    """Return a row per run: what it is, the settings in which the runs differ, its last test.

    runs: or their directories, or names of trained eyes.
    """
    import pandas  # noqa: PLC0415 (takes half a second)

    compared = [each if isinstance(each, Run) else Run(each) for each in runs]
    settings = [by_key(run.configuration) for run in compared]
    varied = [
        key
        for key in dict.fromkeys(key for of in settings for key in of)
        if key.rpartition(".")[2] not in _NOT_COMPARED
        and any(of.get(key) != settings[0].get(key) for of in settings)
    ]
    rows: list[dict[str, Any]] = [
        {
            "run": run.name,
            "profile": run.profile,
            "model": run.model,
            "seed": run.seed,
            **{key: of.get(key) for key in varied},
            **(to_builtins(run.summaries[-1]) if run.summaries else {}),
        }
        for run, of in zip(compared, settings, strict=True)
    ]
    return pandas.json_normalize(rows).set_index("run") if rows else pandas.DataFrame()


@OneThread()
def examine(
    run: Run | str | Path,
    examination: str | Examination,
    *,
    settings: Mapping[str, Any] | None = None,
    test_stimuli: int | None = None,
    **options: Any,
) -> Findings:
    """Examine what a run has learned, without learning, as `abv examine` does.

    run: or its directory, or the name of trained eyes; examination: "cover", "nine-positions" or
    another option of that command, without dashes, or one's own; settings: of the eyes,
    {"eyes.NAME": value}, as --set; test_stimuli: so many at most; options: of the examination.

    `text()` of what is returned are its tables, `frames()` all of them as data frames, `measures()`
    the same as a document. Raises InputError for what cannot be examined.

    Example:
        >>> import active_binocular_vision as abv
        >>> found = abv.examine("runs/first", "landscape", test_stimuli=1, distances_m=(2.0,))
        >>> found.frames()["summary"].shape[0]
        1
    """
    if isinstance(examination, str) and examination not in EXAMINATIONS:
        raise InputError(f"examination: {unknown(examination, EXAMINATIONS)}")
    of_eyes = {}
    for name, value in (settings or {}).items():
        if not name.startswith("eyes."):
            raise InputError(f"settings: expected names that begin with eyes., got {name}")
        of_eyes[name.removeprefix("eyes.")] = value
    directory = run.directory if isinstance(run, Run) else Path(run)
    chosen = EXAMINATIONS[examination] if isinstance(examination, str) else examination
    return chosen.examine(
        FrozenLearners(directory, settings=of_eyes),
        Shown(n_most=test_stimuli),
        build(chosen.options, options),
    )
