"""The scales at which both eyes' pictures are coded: how much each one shows, and how finely."""

import math
from dataclasses import dataclass
from functools import cached_property

from lockstep.errors import InputError
from lockstep.settings import check_settings, setting

# A patch is so wide, and the next one begins so much farther on.
PATCH_SIZE_PX, STRIDE_PX = 8, 4


@dataclass(frozen=True)
class Scale:
    """One scale: a window about the centre of a picture, and the pixels that are coded of it.

    zoom: focal length of the picture over that of the eyes' pictures; focus_d: by how much more the
    eyes focus the light that it is made of.
    """

    name: str
    window_px: int
    size_px: int
    zoom: float
    focus_d: float = 0.0

    @property
    def is_apart(self) -> bool:
        """Whether the eyes take a picture of its own for it, as wide as the window."""
        return self.zoom != 1.0 or self.focus_d != 0.0

    @property
    def n_reductions(self) -> int:
        """Reductions of the window by a factor of 2."""
        return round(math.log2(self.window_px / self.size_px))

    @property
    def px_per_pixel(self) -> float:
        """Pixels of the eyes' pictures in one that is coded."""
        return self.window_px / self.size_px / self.zoom

    @property
    def n_patches(self) -> int:
        """Patches that are coded."""
        return ((self.size_px - PATCH_SIZE_PX) // STRIDE_PX + 1) ** 2


@dataclass(frozen=True)
class ScalesConfig:
    """The scales, one entry of each list for each; the defaults are the published model's (K17 II).

    Raises InputError for values out of range, and lists that do not fit together.
    """

    names: tuple[str, ...] = setting(("coarse", "fine"), "names of the scales, coarse before fine")
    window_px: tuple[int, ...] = setting(
        (128, 40),
        "side of each scale's window about the picture's centre",
        "px",
        least=PATCH_SIZE_PX,
        multiple_of=STRIDE_PX,
    )
    size_px: tuple[int, ...] = setting(
        (32, 40),
        "side of what is coded of each window: all of it, or a half, a quarter and so on",
        "px",
        least=PATCH_SIZE_PX,
        multiple_of=STRIDE_PX,
    )
    zoom: tuple[float, ...] = setting(
        (1.0, 1.0),
        "focal length of the picture that each window is cut from, over that of both cameras; for"
        " another zoom than 1 the eyes take a picture of its own, as wide as the window",
        above=0,
    )
    focus_d: tuple[float, ...] = setting(
        (0.0, 0.0),
        "by how much more the eyes focus the light of each scale, as chromatic aberration has it"
        " of short waves; for another value than 0 the eyes take a picture of its own",
        "D",
        least=-5,
        most=5,
    )
    n_for_lenses: int = setting(
        0,
        "number of scales, the last ones, of which lenses are told and for which they are rewarded,"
        " as the eyes are for the others: these windows are whitened, so that all spatial"
        " frequencies count alike, and their reward is information instead of -E",
        least=0,
    )

    def __post_init__(self) -> None:
        """Refuse values out of range, and lists that do not fit together."""
        check_settings(self)
        n_scales = len(self.names)
        if len(set(self.names)) < n_scales or not all(map(str.isidentifier, self.names)):
            raise InputError(f"names: expected a word for each scale, got {list(self.names)}")
        for name in ("window_px", "size_px", "zoom", "focus_d"):
            values = getattr(self, name)
            if len(values) != n_scales:
                raise InputError(
                    f"{name}: expected {n_scales} entries, of {', '.join(self.names)}, "
                    f"got {list(values)}"
                )
        if self.n_for_lenses >= n_scales:
            raise InputError(
                f"n_for_lenses: expected less than {n_scales} (scales), got {self.n_for_lenses}"
            )
        for scale in self.all:
            if scale.size_px << max(scale.n_reductions, 0) != scale.window_px:
                raise InputError(
                    f"size_px: expected {scale.window_px} px of {scale.name}, its window's, or a "
                    f"half, a quarter and so on of it, got {scale.size_px}"
                )

    @cached_property
    def all(self) -> tuple[Scale, ...]:
        """The scales, in their order."""
        lists = self.names, self.window_px, self.size_px, self.zoom, self.focus_d
        return tuple(Scale(*values) for values in zip(*lists, strict=True))

    @property
    def n_for_eyes(self) -> int:
        """Scales, the first ones, for which the eyes are rewarded."""
        return len(self.names) - self.n_for_lenses

    @property
    def apart(self) -> tuple[Scale, ...]:
        """Those with a picture of their own."""
        return tuple(scale for scale in self.all if scale.is_apart)

    @property
    def widest_px(self) -> int:
        """Side of what all scales together see of the eyes' pictures."""
        return max((scale.window_px for scale in self.all if not scale.is_apart), default=0)


SCALES = ScalesConfig().names
