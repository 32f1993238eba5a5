"""The learning rules by name. Whatever depends on the choice of a rule follows from this table."""

import sys
from dataclasses import dataclass, field, fields
from functools import cache
from importlib import import_module
from importlib.util import module_from_spec, spec_from_file_location
from types import ModuleType
from typing import Any

from lockstep import InputError
from lockstep.written.nearest import did_you_mean
from vergence_rl.cacla.config import CaclaConfig
from vergence_rl.cacla.rule import CaclaRule
from vergence_rl.hindsight.config import HindsightConfig
from vergence_rl.hindsight.rule import HindsightRule

_OF_A_RULE = ("settings", "step", "state", "restore")


@dataclass(frozen=True)
class RuleSettings:
    """The settings of each rule, under its name; a further rule is one line more."""

    cacla: CaclaConfig = field(default_factory=CaclaConfig, metadata={"rule": CaclaRule})
    hindsight: HindsightConfig = field(
        default_factory=HindsightConfig, metadata={"rule": HindsightRule}
    )


RULES: dict[str, Any] = {entry.name: entry.metadata["rule"] for entry in fields(RuleSettings)}


def rule_of(name: str) -> Any:
    """Return the class of a rule of RULES, or the one that FILE.py:CLASS or MODULE:CLASS names.

    Raises InputError for a name that is none, and for a class that is no rule.
    """
    return RULES[name] if name in RULES else _own_rule(name)


def _own_rule(name: str) -> Any:
    where, colon, of_class = name.rpartition(":")
    if not (where and colon and of_class):
        raise InputError(
            f"learning_rule: expected {', '.join(RULES)}, FILE.py:CLASS or MODULE:CLASS, "
            f"got {name!r}{did_you_mean(name, RULES)}"
        )
    try:
        rule = getattr(_module(where), of_class)
    except Exception as error:  # whatever somebody's file raises
        reason = f"{type(error).__name__}: {error}"
        raise InputError(
            f"learning_rule: expected a class that can be imported, got {name!r} ({reason})"
        ) from error
    if missing := [attribute for attribute in _OF_A_RULE if not hasattr(rule, attribute)]:
        raise InputError(
            f"learning_rule: expected a class with {', '.join(_OF_A_RULE)}, got {name!r} without "
            f"{', '.join(missing)}"
        )
    return rule


@cache
def _module(where: str) -> ModuleType:
    """Return the module of a file, always the same one, or of a dotted name."""
    if not where.endswith(".py"):
        return import_module(where)
    spec = spec_from_file_location(where.replace(".", "_"), where)
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    sys.modules[spec.name] = module  # for annotations of dataclasses, and pickle
    spec.loader.exec_module(module)
    return module
