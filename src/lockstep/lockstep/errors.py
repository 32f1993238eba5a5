"""The one error that bad input raises."""


class InputError(ValueError):
    """An input was refused: the message says what was expected and what came."""
