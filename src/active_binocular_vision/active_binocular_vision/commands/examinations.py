"""Examinations as evaluate.sh asks for them."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from active_binocular_vision.examinations.contract.examination import Examination
from active_binocular_vision.examinations.registry import EXAMINATIONS
from active_binocular_vision.figures.examinations.registry import FIGURES
from active_binocular_vision.figures.style import own_style, save
from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.shown import Shown
from lockstep import InputError, build
from lockstep.written.yaml_text import load_yaml


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
        raise InputError(f"--figure: expected one of {_options(FIGURES)}, got --{name}")
    found = examination.examine(learners, shown, options)
    if figure is not None:
        with own_style():
            for addition, draw in FIGURES[name].items():
                save(draw(found.traces), figure.with_stem(f"{figure.stem}{addition}"))
    return examination.document(learners, shown, options, found), found.text()


def _options(names: Any) -> str:
    return ", ".join(f"--{name}" for name in names)
