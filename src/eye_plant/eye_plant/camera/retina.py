"""What becomes of drawn pictures in the eyes: blur, defocus, cataract, cover, and their size."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from eye_plant.camera.blur import Blur
from eye_plant.camera.config import CameraConfig
from eye_plant.camera.defocus import REACH_PX, defocused, disc_diameter_px
from eye_plant.camera.renderer import Renderer, View
from eye_plant.lens.lenses import LensState
from lockstep.scales import Scale

# Of the light that a cataract scatters.
_VEIL = 128.0


class Retina:
    """Both eyes' pictures of one size and focal length."""

    def __init__(
        self,
        config: CameraConfig,
        renderer: Renderer,
        *,
        focuses: bool = False,
        focus_d: float = 0.0,
    ) -> None:
        """Lay out the pictures, and let the renderer draw them.

        config: the region of interest is what the pictures show; focuses: whether lenses may be out
        of focus, so that more than that has to be drawn; focus_d: by how much more they focus.
        """
        self._config, self._renderer, self._focus_d = config, renderer, focus_d
        self._kept_px = config.roi_height_px, config.roi_width_px
        if focuses:
            config = _with_margin(config)
        renderer.reconfigure(config)
        size_px = config.roi_width_px, config.roi_height_px
        self._size_px = size_px[::-1]
        self._blurs = [
            Blur(config.drawn_px, size_px, blur_px) if any(blur_px) else None
            for blur_px in config.blurs_px
        ]

    @classmethod
    def of_scale(
        cls, config: CameraConfig, scale: Scale, renderer: Renderer, *, focuses: bool
    ) -> "Retina":
        """Return that of a scale with a picture of its own, of the eyes with this configuration."""
        side_px = scale.window_px + 2 * REACH_PX
        blurs_px = {
            name: min(getattr(config, name) * scale.zoom, side_px)
            for name in vars(config)
            if name.endswith("blur_px")
        }
        own = replace(
            config,
            focal_length_px=config.focal_length_px * scale.zoom,
            width_px=side_px,
            height_px=side_px,
            roi_width_px=scale.window_px,
            roi_height_px=scale.window_px,
            **blurs_px,
        )
        return cls(own, renderer, focuses=focuses, focus_d=scale.focus_d)

    def drawn(self, view: View) -> NDArray[np.uint8]:
        """Return what the renderer draws, which is the caller's own."""
        return self._renderer.draw(view)

    def seen(
        self, drawn: NDArray[np.uint8], view: View, lenses: LensState | None
    ) -> NDArray[np.uint8]:
        """Return both eyes' pictures (2, roi_height_px, roi_width_px); lenses: of eyes that focus.

        drawn: of the view; what is returned may take its place. What lies before and behind the
        plane is blurred as the plane is.
        """
        config = self._config
        kept = _central(drawn, self._size_px)
        kept = kept if kept.shape == drawn.shape else kept.copy()
        for i_eye, blur in enumerate(self._blurs):
            if blur is not None and not config.occlusions[i_eye]:
                kept[i_eye] = blur(drawn[i_eye])
        if lenses is not None:
            kept = np.stack([self._focused(kept[i], i, view, lenses) for i in range(len(kept))])
        for i_eye, scattered in enumerate(config.cataracts):
            if config.occlusions[i_eye]:
                kept[i_eye] = 0
            elif scattered:
                kept[i_eye] = np.rint((1.0 - scattered) * kept[i_eye] + scattered * _VEIL)
        return kept

    def _focused(
        self, picture: NDArray[np.uint8], i_eye: int, view: View, lenses: LensState
    ) -> NDArray[np.uint8]:
        config = self._config
        error_d = float(lenses.error_d(view.distance_m)[i_eye]) + self._focus_d
        focal_px = config.focal_length_px * config.magnifications[i_eye]
        diameter_px = disc_diameter_px(float(lenses.pupil_m[i_eye]), error_d, focal_px)
        return defocused(picture, diameter_px, self._kept_px)


def _with_margin(config: CameraConfig) -> CameraConfig:
    """Return a configuration whose region of interest is wider by what discs mix into it."""
    return replace(
        config,
        roi_width_px=min(config.width_px, config.roi_width_px + 2 * REACH_PX),
        roi_height_px=min(config.height_px, config.roi_height_px + 2 * REACH_PX),
    )


def _central(pictures: NDArray[np.uint8], size_px: tuple[int, int]) -> NDArray[np.uint8]:
    """Return the centre (2, *size_px) of pictures (2, height, width)."""
    top, left = ((have - n) // 2 for have, n in zip(pictures.shape[1:], size_px, strict=True))
    return pictures[:, top : top + size_px[0], left : left + size_px[1]]
