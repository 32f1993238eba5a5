"""A run whose learners were examined at birth, before its first change and at the end.

examinations.json in the run's directory keeps the documents of the examinations
(`examinations.examination` says what they are), so that a page can be drawn again without
checkpoints. A document is used again for the same training iterations, examination, version and
options, those that it does not know having their defaults, and for the same states of the learners
where their checkpoint is there.
"""

import json
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from active_binocular_vision.examinations.contract.examination import Examination
from active_binocular_vision.examinations.contract.measure import SHARE, measure, record
from active_binocular_vision.examinations.registry import EXAMINATIONS
from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.shown import OWN_TEST_STIMULI
from active_binocular_vision.runs.ages import AGES, BEFORE, BIRTH, END
from active_binocular_vision.runs.groups import Common
from active_binocular_vision.runs.run import EXAMINATIONS_FILE, Run
from experiment_manager import Summary
from experiment_manager.plant_changes import read_schedule
from experiment_manager.sections import config_of
from lockstep import InputError, build, flatten
from lockstep.files.durable_files import replace_file
from sparse_coder import SparseCoderConfig

# The run's own test, a column of pages beside the examinations.
TEST = "test"
# The options of examinations on a page, other than their defaults: eyes that begin at rest show the
# deviation that they are born with.
OPTIONS: Mapping[str, Mapping[str, Any]] = {"cover": {"distances_m": (2.0,), "at_rest": True}}

Document = Mapping[str, Any]


@dataclass(frozen=True, kw_only=True)
class OwnTest:
    """Of the trials of the run's own test, after the last iteration."""

    error_deg: float | None = measure("deg", "|vergence error|")
    iqr_deg: float | None = measure("deg", "IQR")
    share_within_1_px: float | None = measure(SHARE, "within 1 px")
    cost_reduction: float | None = measure("", "c", 2)
    delta_cost_w: float | None = measure("W", "delta C")
    metabolic_rate_w: float | None = measure("W", "C")

    @classmethod
    def of(cls, test: Summary) -> "OwnTest":
        """Return the measures of a test; c of eyes that verge alone."""
        return cls(
            error_deg=test.median_abs_vergence_error_deg,
            iqr_deg=test.iqr_abs_vergence_error_deg,
            share_within_1_px=test.share_within_1_px,
            cost_reduction=test.saving,
            delta_cost_w=test.median_delta_cost_w,
            metabolic_rate_w=test.median_metabolic_rate_w,
        )


@dataclass(frozen=True, kw_only=True)
class ExaminedRun:
    """One run of a condition.

    condition: its profile without the folder; iterations: of training; changed_at: training
    iterations before each of its changes; final_learning_rate: of the dictionaries, 0 if they
    are frozen; px_deg: visual angle of a pixel; curve: training iterations before each test, and
    the median |vergence error| in it; found: by age and examination, TEST included, its document;
    common: what it has in common with other seeds.
    """

    condition: str
    model: str
    seed: int
    iterations: int
    changed_at: tuple[int, ...]
    final_learning_rate: float
    px_deg: float
    curve: tuple[tuple[int, float | None], ...]
    found: Mapping[str, Mapping[str, Document]]
    common: Common

    def value(self, age: str, examination: str, name: str) -> float | None:
        """Return a measure of an examination's summary at an age, None where there is none."""
        document = self.found.get(age, {}).get(examination, {})
        return document.get("summary", {}).get(name)

    def table(self, age: str, examination: str, name: str) -> Sequence[Mapping[str, Any]]:
        """Return the rows of a table of an examination at an age, () where there are none."""
        return self.found.get(age, {}).get(examination, {}).get(name, ())


def examined_run(
    run: Run, common: Common, names: Collection[str], ages: Collection[str] = AGES
) -> ExaminedRun:
    """Examine the learners of a finished run at ages, or read what was found before.

    names: of examinations. An age without a checkpoint and without documents has its test alone.
    Raises InputError for a run that is not finished, has none of the documents and no checkpoint,
    or cannot be examined; OSError when the disk refuses.
    """
    tests = {test.iteration: test for test in run.summaries}
    if not run.is_finished:
        raise InputError(
            f"{run.directory}: expected a run with a test at its end, {run.n_iterations:,}"
        )
    schedule = read_schedule(run.configuration["task"]["schedule"])
    changed_at = tuple(change.at for change in schedule.changes)
    coder = config_of(SparseCoderConfig, run.configuration)
    documents = _documents(run)
    before = [*documents]
    found: dict[str, dict[str, Document]] = {}
    reasons: list[str] = []
    for age, iteration in ages_of([*tests], changed_at[0] if changed_at else None).items():
        if age in ages:
            found[age] = {TEST: {"summary": record(OwnTest.of(tests[iteration]))}}
            try:
                found[age] |= _at(run, iteration, names, documents)
            except InputError as error:
                reasons.append(str(error))
    if documents != before:
        lines = ",\n".join(json.dumps(of, allow_nan=False) for of in documents)
        replace_file(run.directory / EXAMINATIONS_FILE, f'{{"examined": [\n{lines}\n]}}\n'.encode())
    if reasons and not any(len(of_age) > 1 for of_age in found.values()):
        raise InputError(reasons[-1])
    return ExaminedRun(
        condition=run.profile.rpartition("/")[2] or run.name,
        model=run.model,
        seed=run.seed,
        iterations=run.n_iterations,
        changed_at=changed_at,
        final_learning_rate=coder.learning_rate * coder.final_learning_rate_share,
        px_deg=run.evaluation_settings.criteria(run.n_iterations).px_deg,
        curve=tuple((n, test.median_abs_vergence_error_deg) for n, test in tests.items()),
        found=found,
        common=common,
    )


def _documents(run: Run) -> list[Document]:
    """Return what was found in a run before; InputError for another content."""
    try:
        return [dict(of) for of in run.examinations["examined"]]
    except (ValueError, KeyError, TypeError) as error:
        raise InputError(
            f"{run.directory}: expected the examinations of a run: {error!r}"
        ) from error


def _at(
    run: Run, iteration: int, names: Collection[str], documents: list[Document]
) -> dict[str, Document]:
    """Return examinations after training iterations; those that are made go into documents.

    Raises InputError where one is missing and there is no checkpoint.
    """
    try:
        learners = FrozenLearners.after(run.directory, iteration)
    except InputError:
        learners = None
    return {
        name: _document(run, iteration, EXAMINATIONS[name], learners, documents) for name in names
    }


def _document(
    run: Run,
    iteration: int,
    examination: Examination,
    learners: FrozenLearners | None,
    documents: list[Document],
) -> Document:
    chosen = flatten(examination.options(**OPTIONS.get(examination.name, {})))
    place = {"iteration": iteration, "examination": examination.name, "options": chosen}
    key = place | {"version": examination.version}
    if learners is not None:
        key["states"] = learners.state_hash
    defaults = flatten(examination.options())
    for document in documents:
        if _has(document, key, defaults):
            return document
    if learners is None:
        raise InputError(
            f"{run.directory}: expected a checkpoint after {iteration:,} training iterations, or "
            f"{examination.name} of version {examination.version} in {EXAMINATIONS_FILE}"
        )
    options = build(examination.options, chosen)
    found = examination.examine(learners, OWN_TEST_STIMULI, options)
    new = examination.document(learners, OWN_TEST_STIMULI, options, found)
    documents[:] = [*(old for old in documents if not _has(old, place, defaults)), new]
    return new


def _has(document: Document, values: Document, defaults: Mapping[str, Any]) -> bool:
    """Whether a document has these values; defaults: of options, as older ones lack some."""
    complete = {**document, "options": {**defaults, **document.get("options", {})}}
    return all(complete.get(name) == value for name, value in values.items())


def ages_of(tested: Sequence[int], changed_at: int | None) -> Mapping[str, int]:
    """Return the training iterations of each of AGES that a run has been tested at.

    tested: training iterations before each test, rising, the last one at the end; changed_at: those
    before the first change. A test at that very iteration still comes before it.
    """
    before = [n for n in tested[:-1] if changed_at is not None and 0 < n <= changed_at]
    ages = {BIRTH: 0} if tested[0] == 0 else {}
    return ages | ({BEFORE: before[-1]} if before else {}) | {END: tested[-1]}
