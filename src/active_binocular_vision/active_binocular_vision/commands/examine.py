"""Tests the frozen learners of a run: with any pictures, or with an examination."""

import argparse
import json
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from active_binocular_vision.command_lines.examine import parser
from active_binocular_vision.commands.command_line import plant_settings
from active_binocular_vision.examinations.contract.examination import Examination
from active_binocular_vision.examinations.registry import EXAMINATIONS
from active_binocular_vision.figures.examinations.registry import FIGURES
from active_binocular_vision.figures.style import own_style, save
from active_binocular_vision.learners.evaluation import evaluated
from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.shown import Shown
from experiment_manager.measures.results import write_document
from experiment_manager.measures.tables import summaries_table
from lockstep import InputError, build
from lockstep.exit_codes import EXIT_BAD_INPUT
from lockstep.written.yaml_text import load_yaml


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; return 0, or 2 for bad input."""
    line = parser()
    options = line.parse_args(arguments)
    for name in ("figure", "option"):
        if getattr(options, name) and options.examination is None:
            line.error(f"--{name}: expected with one of {_options(EXAMINATIONS)}")
    for name in ("start_scale", "start_errors"):
        if options.examination is not None and getattr(options, name) is not None:
            option = f"--{name.replace('_', '-')}"
            line.error(f"{option}: expected without an examination, which has starts of its own")
    try:
        _examine(options)
    except (InputError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return EXIT_BAD_INPUT
    return 0


def _examine(options: argparse.Namespace) -> None:
    learners = FrozenLearners(
        options.run,
        options.checkpoint,
        dictionary=options.dictionary,
        actor=options.actor,
        settings=plant_settings(options.set),
    )
    shown = Shown(
        options.stimuli,
        options.stereograms,
        options.random_dots,
        options.generated,
        options.test_stimuli,
    )
    if options.examination is not None:
        document, table = examined(
            options.examination, learners, shown, options.figure, options.option
        )
    else:
        start_scale = 1.0 if options.start_scale is None else options.start_scale
        results = evaluated(learners, shown, start_scale, options.start_errors)
        document, table = results.to_json(), summaries_table([results.test])
    if options.json == Path("-"):
        print(json.dumps(document, indent=2))
    else:
        manager = learners.manager
        print(
            f"model {manager.model}, seed {manager.seed}, checkpoint after "
            f"{learners.place} episodes, {document['n_stimuli']} stimuli of "
            f"{document['stimuli'] or 'its own test stimuli'}\n\n{table}"
        )
        if options.json is not None:
            write_document(options.json, document)
            print(f"written: {options.json}", file=sys.stderr)


def options_of(examination: Examination, texts: Sequence[str]) -> Any:
    """Return the options of an examination that NAME=VALUE texts change.

    Raises InputError for one that it does not have or take.
    """
    pairs = [text.partition("=") for text in texts]
    try:
        for text, (name, equals, _) in zip(texts, pairs, strict=True):
            if not equals or [other for other, *_ in pairs].count(name) > 1:
                raise InputError(f"expected each NAME=VALUE once, got {text!r}")
        values = {name: load_yaml(value) for name, _, value in pairs}
        return build(examination.options, values)
    except InputError as error:
        raise InputError(f"--option: {error}") from error


def examined(
    name: str, learners: FrozenLearners, shown: Shown, figure: Path | None, texts: Sequence[str]
) -> tuple[dict[str, Any], str]:
    """Make an examination and draw its figures; return the measures as a document and as text.

    texts: of options, NAME=VALUE. Raises InputError for what cannot be examined or drawn.
    """
    examination = EXAMINATIONS[name]
    options = options_of(examination, texts)
    if figure is not None and figure.suffix.lower() != ".png":
        raise InputError(f"--figure: expected a name that ends in .png, got {figure}")
    if figure is not None and name not in FIGURES:
        raise InputError(
            f"--figure: expected one of {_options(FIGURES)}, got --{name}, of which --json writes"
            " the numbers"
        )
    found = examination.examine(learners, shown, options)
    if figure is not None:
        with own_style():
            for addition, draw in FIGURES[name].items():
                save(draw(found.traces), figure.with_stem(f"{figure.stem}{addition}"))
    return examination.document(learners, shown, options, found), found.text()


def _options(names: Iterable[str]) -> str:
    return ", ".join(f"--{name}" for name in names)
