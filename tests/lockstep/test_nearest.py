"""Names like a mistyped one."""

from lockstep.nearest import did_you_mean, nearest

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
