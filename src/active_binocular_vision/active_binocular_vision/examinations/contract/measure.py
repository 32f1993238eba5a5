"""One declaration per measure: its label and unit, from which JSON, tables and columns follow.

A row of an examination is a dataclass whose fields are declared with `measure`; those declared with
`key` tell rows apart. `record` makes of a row what JSON has, `text_of` of rows a table for a
terminal; `columns_of` a class are the columns of the page of conditions.
"""

import dataclasses
import math
from collections.abc import Sequence
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike

from experiment_manager.measures.metrics import QUARTILES
from experiment_manager.measures.tables import number, percent, text_table

# Unit of what is between 0 and 1, and shown in percent.
SHARE = "share"
_KEY = "measure"


class Quartiles(NamedTuple):
    """Quartiles over trials; None where a quartile lies beyond what was tried."""

    lower_quartile: float | None
    median: float | None
    upper_quartile: float | None

    @classmethod
    def of(cls, values: ArrayLike) -> Self:
        """Return the quartiles of values (n,), linear between two values."""
        return cls._known(np.quantile(np.asarray(values, np.float64), QUARTILES).tolist())

    @classmethod
    def of_censored(cls, values: Sequence[float]) -> Self:
        """Return quartiles of values some of which are infinite, beyond what was tried.

        Each quartile is one of the values.
        """
        return cls._known(np.quantile(values, QUARTILES, method="inverted_cdf").tolist())

    @classmethod
    def _known(cls, values: Sequence[float]) -> Self:
        return cls(*(value if math.isfinite(value) else None for value in values))

    @property
    def prism_dioptres(self) -> "Quartiles":
        """Quartiles in deg as 100 tan(angle), the deviation in cm at 1 m (Prentice 1890)."""
        return Quartiles(*map(prism_dioptres, self))


def prism_dioptres(angle_deg: float | None) -> float | None:
    """Return 100 tan(angle); None for None."""
    return None if angle_deg is None else 100.0 * math.tan(math.radians(angle_deg))


@dataclasses.dataclass(frozen=True)
class Measure:
    """What is known of a field beside its name and type.

    label: what a table calls it; unit: "" for none, SHARE is shown in percent; n_digits: behind the
    point in a table; columns: names of the entries of an array, which JSON has in place of the
    field's name; labels: what a table calls these; is_key: tells rows apart; is_shown: in a table;
    spread: whether a table shows the quartiles beside the median.
    """

    label: str
    unit: str = ""
    n_digits: int = 3
    columns: tuple[str, ...] = ()
    labels: tuple[str, ...] = ()
    is_key: bool = False
    is_shown: bool = True
    spread: bool = False

    @property
    def headings(self) -> tuple[str, ...]:
        """What a table calls the columns of the field, with the unit."""
        unit = "" if self.unit in ("", SHARE) else f"/{self.unit}"
        unit = f"/({self.unit})" if "/" in self.unit else unit
        return tuple(f"{label}{unit}" for label in self.labels or self.columns or (self.label,))

    def cell(self, value: Any) -> str:
        """Return a value, or one entry of an array, as a table shows it."""
        if isinstance(value, Quartiles):
            median = self.cell(value.median)
            lower, _, upper = map(self.cell, value)
            return f"{median} ({lower} to {upper})" if self.spread else median
        if isinstance(value, str):
            return value
        if value is None or not math.isfinite(value):
            return "-"
        if self.is_key:
            return f"{value:g}"
        return percent(value) if self.unit == SHARE else number(value, self.n_digits)


def measure(unit: str, label: str, n_digits: int = 3, **more: Any) -> Any:
    """Return a dataclass field of a row; more: other fields of `Measure`, and a `default`."""
    default = more.pop("default", dataclasses.MISSING)
    declared = Measure(label, unit, n_digits, **more)
    return dataclasses.field(default=default, metadata={_KEY: declared})


def key(label: str, unit: str = "", **more: Any) -> Any:
    """Return a dataclass field that tells rows apart."""
    return measure(unit, label, is_key=True, **more)


def measures_of(row_class: Any) -> dict[str, Measure]:
    """Return what each field of a row, or of its class, is declared as."""
    return {field.name: field.metadata[_KEY] for field in dataclasses.fields(row_class)}


def record(row: Any) -> dict[str, Any]:
    """Return a row as JSON has it; None stands for what is not finite."""
    return {
        column: _plain(value)
        for name, declared in measures_of(row).items()
        for column, value in zip(
            declared.columns or (name,), _entries(declared, getattr(row, name)), strict=True
        )
    }


def columns_of(row_class: Any) -> dict[str, tuple[Measure, str]]:
    """Return each column that `record` makes of a row, by its name, with its heading."""
    return {
        name: (declared, heading)
        for field_name, declared in measures_of(row_class).items()
        for name, heading in zip(declared.columns or (field_name,), declared.headings, strict=True)
    }


def text_of(rows: Sequence[Any]) -> str:
    """Return rows of one class as a table; "" without any."""
    if not rows:
        return ""
    keys_first = sorted(measures_of(rows[0]).items(), key=lambda item: not item[1].is_key)
    shown = {name: declared for name, declared in keys_first if declared.is_shown}
    header = [heading for declared in shown.values() for heading in declared.headings]
    n_left = next((i for i, of in enumerate(shown.values()) if not of.is_key), len(shown))
    lines = [
        [
            declared.cell(entry)
            for name, declared in shown.items()
            for entry in _entries(declared, getattr(row, name))
        ]
        for row in rows
    ]
    return text_table(header, lines, n_left)


def _entries(declared: Measure, value: Any) -> Sequence[Any]:
    if not declared.columns:
        return (value,)
    return np.ravel(value).tolist() if isinstance(value, np.ndarray) else value


def _plain(value: Any) -> Any:
    if isinstance(value, Quartiles):
        return value._asdict()
    if isinstance(value, np.ndarray | list | tuple):
        return [_plain(entry) for entry in np.asarray(value).tolist()]
    if isinstance(value, np.generic):
        value = value.item()
    return None if isinstance(value, float) and not math.isfinite(value) else value
