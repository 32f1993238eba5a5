"""InputError: a ValueError whose text stays readable."""

from lockstep import InputError


def test_long_texts_keep_their_ends() -> None:
    text = str(InputError("begin " + "x" * 100_000 + " end"))
    assert len(text) < 600
    assert text.startswith("begin x")
    assert " ... " in text
    assert text.endswith("x end")
