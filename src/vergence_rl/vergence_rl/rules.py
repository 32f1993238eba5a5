"""The learning rules by name. Whatever depends on the choice of a rule follows from this table."""

from dataclasses import dataclass, field, fields
from typing import Any

from vergence_rl.cacla.config import CaclaConfig
from vergence_rl.cacla.rule import CaclaRule
from vergence_rl.hindsight.config import HindsightConfig
from vergence_rl.hindsight.rule import HindsightRule


@dataclass(frozen=True)
class RuleSettings:
    """The settings of each rule, under its name; a further rule is one line more."""

    cacla: CaclaConfig = field(default_factory=CaclaConfig, metadata={"rule": CaclaRule})
    hindsight: HindsightConfig = field(
        default_factory=HindsightConfig, metadata={"rule": HindsightRule}
    )


RULES: dict[str, Any] = {entry.name: entry.metadata["rule"] for entry in fields(RuleSettings)}
