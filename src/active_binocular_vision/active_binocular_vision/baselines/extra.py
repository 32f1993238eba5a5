"""Packages that only some baselines need, the extra `rl`."""

from importlib import import_module
from typing import Any

from lockstep import InputError


def extra(name: str) -> Any:
    """Return a package of the extra; raises InputError that says how to install it."""
    try:
        return import_module(name)
    except ImportError as error:
        raise InputError(
            f"expected the package {name} for this method, got none ({error}): "
            "pip install stable-baselines3 cma"
        ) from error
