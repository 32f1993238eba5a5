"""One line of the validation: a measured value and the bound it is held against."""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Row:
    """A measurement. value is nan and ok None when it could not be made here.

    low, high: the bound; low may be infinite.
    """

    name: str
    value: float
    unit: str
    low: float = -math.inf
    high: float = math.inf

    @property
    def ok(self) -> bool | None:
        """Whether the value is within the bound; None when there is no value."""
        return None if math.isnan(self.value) else bool(self.low <= self.value <= self.high)

    @property
    def bound(self) -> str:
        """The bound in words."""
        if math.isinf(self.low):
            return f"at most {self.high:g}"
        return f"{self.low:g} to {self.high:g}"

    def as_dict(self) -> dict[str, object]:
        """Return the row as it is written to plant_validation.json."""
        return {
            "name": self.name,
            "value": None if self.ok is None else float(self.value),
            "unit": self.unit,
            "bound": self.bound,
            "ok": self.ok,
        }
