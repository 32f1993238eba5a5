"""What an examination is: frozen learners in, rows out; the same document for each.

The document that abv examine writes, and each entry of a run's examinations.json:

    model, seed, commit, lambda, checkpoint, dictionary, actor, settings    the learners
    iteration, states       training iterations before, and a hash of the learners' states
    examination, version    name, and number that rises when a measure is defined otherwise
    options                 of the examination, all of them
    stimuli, n_stimuli      what was shown, "" for the run's own test stimuli
    summary                 {measure: number}: the columns of the page of conditions
    TABLE                   [{measure: value}]: the rows of each of the examination's tables

Values are numbers, texts, null for what is not known or beyond what was tried, lists, and for
quartiles over trials {lower_quartile, median, upper_quartile}. The fields of an examination's row
classes are its measures.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from active_binocular_vision.examinations.contract.declared import Declared
from active_binocular_vision.examinations.contract.measure import record, text_of
from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.shown import OWN_TEST_STIMULI, Shown
from lockstep import flatten

if TYPE_CHECKING:
    import pandas


@dataclass(frozen=True, kw_only=True)
class Findings:
    """What an examination found.

    summary: one row, of numbers alone; tables: rows by the name that the document has for them;
    titles: what a terminal shows above tables, those without a title are only in the document;
    notes: what follows them; traces: what figures are drawn from besides.
    """

    n_stimuli: int
    summary: Any
    tables: Mapping[str, Sequence[Any]]
    titles: Mapping[str, str] = field(default_factory=dict)
    notes: str = ""
    traces: Any = None

    def text(self) -> str:
        """Return the tables for a terminal."""
        tables = {"summary": [self.summary], **self.tables}
        parts = [
            f"{title}\n{text_of(tables[name])}".lstrip("\n") for name, title in self.titles.items()
        ]
        return "\n\n".join([*parts, *([self.notes] if self.notes else [])])

    def frames(self) -> "dict[str, pandas.DataFrame]":
        """Return the summary, a row, and each table; quartiles are NAME.median and so on."""
        import pandas  # noqa: PLC0415 (takes half a second)

        found = self.measures()
        return {name: pandas.json_normalize(found[name]) for name in ("summary", *self.tables)}

    def measures(self) -> dict[str, Any]:
        """Return the measured part of the document."""
        tables = {name: [*map(record, rows)] for name, rows in self.tables.items()}
        return {"n_stimuli": self.n_stimuli, "summary": record(self.summary)} | tables


@dataclass(frozen=True, kw_only=True)
class Examination:
    """An examination.

    declared: its name and options; version: rises when a measure is defined otherwise; examine:
    (learners, shown, options) -> Findings, raises InputError for learners, pictures or options that
    cannot be used; summary: class of the summary's row.
    """

    declared: Declared
    examine: Callable[[FrozenLearners, Shown, Any], Findings]
    summary: type[Any]
    version: int = 1

    @property
    def name(self) -> str:
        """Option of abv examine."""
        return self.declared.name

    @property
    def options(self) -> type[Any]:
        """Class of its options."""
        return self.declared.options

    def document(
        self, learners: FrozenLearners, shown: Shown, options: Any, found: Findings
    ) -> Any:
        """Return what abv examine writes."""
        return (
            learners.said()
            | {
                "examination": self.name,
                "version": self.version,
                "options": flatten(options),
                "stimuli": shown.text,
            }
            | found.measures()
        )

    def __call__(
        self, learners: FrozenLearners, shown: Shown = OWN_TEST_STIMULI, **options: Any
    ) -> Findings:
        """Make the examination; options: other than the defaults."""
        return self.examine(learners, shown, self.options(**options))
