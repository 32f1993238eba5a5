"""Names like a mistyped one."""

from lockstep.written.nearest import did_you_mean, nearest, unknown

KNOWN = ("camera.width_px", "camera.height_px", "discount", "seed", "rearing/monocular")


def test_the_most_alike_comes_first() -> None:
    assert nearest("camera.widht_px", KNOWN)[0] == "camera.width_px"
    assert nearest("discont", KNOWN) == ["discount"]


def test_a_name_without_its_folder() -> None:
    assert nearest("width_px", KNOWN)[0] == "camera.width_px"
    assert nearest("monocullar", KNOWN) == ["rearing/monocular"]


def test_nothing_is_like_another_word() -> None:
    assert nearest("zzz", KNOWN) == []


def test_the_question() -> None:
    assert did_you_mean("discont", KNOWN) == "; did you mean discount?"
    assert did_you_mean("zzz", KNOWN) == ""


def test_a_name_that_was_begun() -> None:
    assert nearest("disc", KNOWN) == ["discount"]
    assert nearest("mono", KNOWN) == ["rearing/monocular"]


def test_what_an_error_says_of_an_unknown_name() -> None:
    hint = "expected a known name, got 'discont'; did you mean discount?"
    assert unknown("discont", KNOWN) == hint
    assert unknown("zzz", ("b", "a")) == "expected one of b, a, got 'zzz'"
    many = ("paper", *(f"rearing/{i}" for i in range(100)))
    assert unknown("zzz", many) == "expected one of paper, rearing/*, got 'zzz'"
