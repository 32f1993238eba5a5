"""InputError: a ValueError whose text stays readable."""

from lockstep import InputError


def test_long_texts_keep_their_ends() -> None:
    text = str(InputError("begin " + "x" * 100_000 + " end"))
    assert len(text) < 600
    assert text.startswith("begin x")
    assert " ... " in text
    assert text.endswith("x end")


def test_a_list_of_faults_may_be_longer() -> None:
    assert str(InputError(1000 * "x", longest=1000)) == 1000 * "x"


def test_an_error_may_be_made_of_another_one() -> None:
    # As Gymnasium's processes raise what a worker has raised: kind(error).
    assert str(InputError(InputError("seed: expected"))) == "seed: expected"
