"""The text of a whole config.yaml, at the defaults except where a test says otherwise."""

from typing import Any

from experiment_manager.run.config_file import configuration_text
from experiment_manager.sections import DEFAULTS


def config_text(**settings: dict[str, Any]) -> str:
    """Return config.yaml; settings: {name: value} by section."""
    return configuration_text(
        {section: values | settings.get(section, {}) for section, values in DEFAULTS.items()}
    )
