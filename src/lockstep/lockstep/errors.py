"""The errors with a meaning of their own: of bad input, and of learning that diverges."""

_LONGEST = 500


class InputError(ValueError):
    """An input was refused: the message says what was expected and what came.

    A text too long to read is shortened in its middle: what came may be of any size.
    """

    def __init__(self, text: object, longest: int = _LONGEST) -> None:
        """text: the message, or an error with it, as Gymnasium makes that of a worker again.

        longest: characters of which nothing is left out.
        """
        text = str(text)
        if len(text) > longest:
            text = f"{text[: longest // 2]} ... {text[-longest // 2 :]}"
        super().__init__(text)


class DivergenceError(ArithmeticError):
    """A learner's weights or values are beyond what learning reaches; the run cannot continue.

    The message names the training iteration and the quantity.
    """
