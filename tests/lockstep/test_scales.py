from typing import Any

import pytest

from lockstep import InputError
from lockstep.scales import ScalesConfig

THREE = ScalesConfig(
    names=("coarse", "fine", "foveal"),
    window_px=(128, 40, 40),
    size_px=(32, 40, 40),
    zoom=(1.0, 1.0, 4.0),
    focus_d=(0.0, 0.0, 0.0),
)


def test_the_published_model_has_two_scales_of_the_eyes_own_pictures() -> None:
    coarse, fine = ScalesConfig().all
    assert (coarse.name, coarse.n_reductions, coarse.px_per_pixel) == ("coarse", 2, 4.0)
    assert (fine.name, fine.n_reductions, fine.px_per_pixel) == ("fine", 0, 1.0)
    assert (coarse.n_patches, fine.n_patches) == (49, 81)
    assert ScalesConfig().apart == ()
    assert ScalesConfig().widest_px == 128


def test_a_zoomed_scale_has_a_picture_of_its_own_and_smaller_pixels() -> None:
    (foveal,) = THREE.apart
    assert (foveal.name, foveal.px_per_pixel, foveal.n_patches) == ("foveal", 0.25, 81)
    assert THREE.widest_px == 128


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"names": ("coarse", "coarse")}, "names: expected a word for each scale, got .*'coarse'"),
        ({"names": ("coarse", "no word")}, "names: expected a word"),
        ({"window_px": (128,)}, r"window_px: expected 2 entries, of coarse, fine, got \[128\]"),
        ({"window_px": (126, 40)}, "window_px: expected a multiple of 4"),
        ({"size_px": (32, 20, 20)}, "size_px: expected 2 entries"),
        ({"size_px": (48, 40)}, "size_px: expected 128 px of coarse, .*a half.*, got 48"),
        ({"size_px": (256, 40)}, "size_px: expected 128 px of coarse, .*got 256"),
        ({"focus_d": (0.5,)}, "focus_d: expected 2 entries"),
        ({"zoom": (1.0, 0.0)}, "zoom: expected more than 0"),
    ],
)
def test_lists_that_do_not_fit_are_refused(settings: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        ScalesConfig(**settings)
