"""What eyes did at the nine positions, as evaluate.sh prints, writes and draws it."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

from experiment_manager.frozen.learners import FrozenLearners
from experiment_manager.frozen.shown import OWN_TEST_STIMULI, Shown
from experiment_manager.positions.document import document
from experiment_manager.positions.examination import Examined, examine
from experiment_manager.positions.text import tables


@dataclass(frozen=True)
class NinePositions:
    """An examination that was made."""

    examined: Examined

    @cached_property
    def _document(self) -> dict[str, Any]:
        return document(self.examined)

    def to_json(self) -> dict[str, Any]:
        """Return what evaluate.sh writes."""
        return self._document

    def table(self) -> str:
        """Return the tables as text."""
        return tables(self._document)


def examine_positions(
    learners: FrozenLearners, shown: Shown = OWN_TEST_STIMULI, covered: str = ""
) -> NinePositions:
    """Make the examination; covered, errors: as `examine` has them."""
    return NinePositions(examine(learners, shown, covered))
