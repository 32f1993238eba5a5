"""Shows what a bag holds, films it, repairs a cut-off one, extracts its pictures."""

import math
import sys
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np

from active_binocular_vision.command_lines.bag import parser
from active_binocular_vision.film.film import film
from active_binocular_vision.runs.recorded import evaluation_settings_of, trial_table
from experiment_manager import Bag, summary_of
from experiment_manager.bag.metadata import CONFIGURATION_ATTACHMENT, RUN_METADATA
from experiment_manager.bag.repair import repair_bag
from experiment_manager.measures.tables import summaries_table, text_table
from experiment_manager.measures.trials import split_tests
from lockstep import InputError
from lockstep.exit_codes import EXIT_BAD_INPUT, EXIT_INTERRUPTED
from lockstep.files.durable_files import is_free
from lockstep.wire.topics import PARAMETER_CHANGES

_VECTOR = "sensor_msgs/msg/JointState"
_IMAGE = "sensor_msgs/msg/Image"
_NS_PER_S = 1e9


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; return its exit code: 0, or 2 with one line that says what is wrong."""
    options = parser().parse_args(arguments)
    path = options.bag / "bag" if (options.bag / "bag").is_dir() else options.bag
    try:
        if options.repair:
            _print_repairs(path)
        if options.film is not None:
            duration_s = film(path, options.film, _rate(options.rate))
            print(f"wrote {options.film}, {duration_s:.0f} s")
            return 0
        bag = Bag(path)
        if options.extract is not None:
            _extract(bag, options.extract)
        print(describe(bag, with_configuration=options.configuration))
    except (InputError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return EXIT_BAD_INPUT
    except KeyboardInterrupt:
        return EXIT_INTERRUPTED
    return 0


def _rate(rate: float | None) -> float | None:
    if rate is not None and not 0.0 < rate < math.inf:
        raise InputError(f"--rate: expected more than 0, got {rate:g}")
    return rate


def describe(bag: Bag, *, with_configuration: bool) -> str:
    """Return what a bag holds, as text for a terminal."""
    about = bag.metadata.get(RUN_METADATA, {})
    run = "\n".join(f"{key}: {text}" for key, text in about.items())
    parts = [_files(bag), run, _learning_curve(bag), _topics(bag)]
    if with_configuration:
        configuration = bag.attachment(CONFIGURATION_ATTACHMENT).decode().rstrip()
        parts.append(f"{CONFIGURATION_ATTACHMENT}:\n\n{configuration}")
    return "\n\n".join(part for part in parts if part)


def _files(bag: Bag) -> str:
    n_bytes = sum(file.path.stat().st_size for file in bag.files)
    cut_off = [file.path.name for file in bag.files if not file.complete]
    state = "whole"
    n_files = len(bag.files)
    if cut_off:
        state = f"{', '.join(cut_off)} cut off (--repair completes it)"
    return f"{bag.path}: {n_files} file{'s' * (n_files != 1)}, {n_bytes / 1e6:.1f} MB, {state}"


def _topics(bag: Bag) -> str:
    stamps = {topic: np.unique(bag.stamps_ns(topic)) for topic in sorted(bag.types)}
    regular = {
        topic
        for topic, type_name in bag.types.items()
        if type_name == _VECTOR and not topic.endswith(f"/{PARAMETER_CHANGES}")
    }
    periods = [np.diff(s).min() for t, s in stamps.items() if t in regular and s.size > 1]
    period_ns = min(periods, default=0)
    header = ("topic", "type", "messages", "rate/Hz", "gaps", "longest gap/s")
    rows = [
        (
            topic,
            bag.types[topic],
            str(len(bag.stamps_ns(topic))),
            *(_rhythm(s, period_ns) if topic in regular else ("-", "-", "-")),
        )
        for topic, s in stamps.items()
    ]
    note = (
        f"Rates and gaps in simulated time. A gap is longer than two periods of {period_ns / 1e9:g}"
        " s; an episode's last observation is not answered. Images (a sample), changes of the "
        "plant and diagnostics (in real time) have no gaps."
    )
    return f"{text_table(header, rows, n_left=2)}\n{note}"


def _rhythm(stamps_ns: np.ndarray, period_ns: int) -> tuple[str, str, str]:
    """Return rate, number of gaps and longest gap of increasing stamps (n,)."""
    if len(stamps_ns) < 2:
        return "-", "-", "-"
    steps_ns = np.diff(stamps_ns)
    rate = len(steps_ns) / (float(stamps_ns[-1] - stamps_ns[0]) / _NS_PER_S)
    gaps_ns = steps_ns[steps_ns > 2 * period_ns]
    longest = f"{gaps_ns.max() / _NS_PER_S:.1f}" if len(gaps_ns) else "-"
    return f"{rate:.3g}", str(len(gaps_ns)), longest


def _learning_curve(bag: Bag) -> str:
    if not bag.has("ground_truth"):
        return ""
    tables = bag.vectors(*(t for t in ("ground_truth", "muscle_activations") if bag.has(t)))
    truth = tables["ground_truth"]
    if not len(truth.stamps_ns):
        return ""
    settings = evaluation_settings_of(bag)
    table = trial_table(truth, tables.get("muscle_activations"), settings.plant.space)
    summaries = [
        summary_of(trials, settings.criteria(trials.training_iteration))
        for trials in split_tests(table, settings.iterations_per_trial)
    ]
    return summaries_table(summaries) if summaries else "No complete trial of a test."


def _print_repairs(path: Path) -> None:
    repairs = repair_bag(path)
    for name, kept in repairs.items():
        print(f"{name}: {kept.n_messages} messages kept, {kept.n_lost_chunks} chunks lost")
    if not repairs:
        print("nothing to repair")


def _extract(bag: Bag, directory: Path) -> None:
    if not is_free(directory):
        raise InputError(f"expected a new or empty directory for images, got {directory}")
    n_pictures = 0
    for topic in (topic for topic, kind in bag.types.items() if kind == _IMAGE):
        below = directory / topic.strip("/")
        below.mkdir(parents=True, exist_ok=True)
        for stamp_ns, picture in bag.images(topic):
            if not cv2.imwrite(str(below / f"{stamp_ns:019d}.png"), _as_grey(picture)):
                raise OSError(f"cannot write an image below {below}")
            n_pictures += 1
    print(f"{n_pictures} images below {directory}")


def _as_grey(picture: np.ndarray) -> np.ndarray:
    """Return a picture as uint8; numbers are scaled so that their largest is white."""
    if picture.dtype == np.uint8:
        return picture
    largest = float(np.nanmax(picture, initial=0.0))
    scaled = np.clip(np.nan_to_num(picture) / (largest or 1.0), 0.0, 1.0)
    return np.round(255 * scaled).astype(np.uint8)
