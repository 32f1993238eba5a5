"""Numbers as people write them on a command line or in a sweep's file: 1e5, 1_000, 0,500."""

from lockstep import InputError


def whole_number(text: str) -> int:
    """Return the whole number that a text is; raises InputError for another text."""
    try:
        is_whole = not {"e", "."} & set(text.lower())
        return int(text) if is_whole else _exact(float(text.replace("_", "")))
    except (ValueError, OverflowError) as error:
        raise InputError(f"expected a whole number, got {text!r}") from error


def whole_numbers(text: str) -> tuple[int, ...]:
    """Return the whole numbers of a text, which commas part; errors as for one."""
    return tuple(whole_number(part) for part in text.split(","))


def number(text: str) -> float:
    """Return the number that a text is; raises InputError for another text."""
    try:
        return float(text)
    except ValueError as error:
        raise InputError(f"expected a number, got {text!r}") from error


def _exact(value: float) -> int:
    if not value.is_integer():
        raise ValueError(value)
    return int(value)
