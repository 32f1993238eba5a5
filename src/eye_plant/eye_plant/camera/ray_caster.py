"""Rays from an eye's pixels to two textured rectangles that face it, in compiled loops.

A pixel at column c and row r of the full picture sees the texture coordinates (u, v) = (x, y) / w,
where (x, y, w) = H (c, r, 1): a plane through a pinhole is a homography H. (0, 0) is the texture's
top left corner, (1, 1) its bottom right one, and w is the ray's step along the world's x axis.

The picture is that of OpenGL's software renderer: one ray through each pixel's centre, one bilinear
sample from the mip-map level that is nearest to the longer of the steps in texture coordinates
between the pixels of a block of two by two (OpenGL 4.5 specification, section 8.14).
"""

import numpy as np
from numba import bool_, float32, float64, int32, int64, njit, types, uint8, void
from numpy.typing import NDArray

Floats = NDArray[np.float64]

# Pixels to a side of a tile, which is drawn row by row; even, so that it holds whole blocks.
_TILE_PX = 16
# Read-only arrays, such as those mapped from a file, can be passed as well as others.
_TEXELS = types.Array(uint8, 1, "C", readonly=True)
_LEVELS = types.Array(int64, 2, "C", readonly=True)
_TEXTURE = types.Tuple((_TEXELS, _TEXELS, _LEVELS))


@njit(
    void(float64[:], float64[:, :], float64[:], float64[:], float64[:, ::1]), cache=True, nogil=True
)
def find_homography(
    position_m: Floats,
    rotation: Floats,
    rectangle_m: Floats,
    intrinsics_px: Floats,
    homography: Floats,
) -> None:
    """Fill homography (3, 3) of one eye and one rectangle.

    position_m (3,), rotation (3, 3): the eye's pose as StereoCamera.render takes it; rectangle_m:
    distance x, centre's height z, width and height; intrinsics_px: focal length, column and row of
    the picture's centre.
    """
    ahead_m = rectangle_m[0] - position_m[0]
    above_m = position_m[2] - rectangle_m[1]
    width_m, height_m = rectangle_m[2], rectangle_m[3]
    focal_length, column, row = intrinsics_px
    for i in range(3):
        # The ray of (c, r, 1) is F x - (c - c0) y - (r - r0) z, in the eye's own axes.
        if i < 2:
            ray = -rotation[:, i + 1]
        else:
            ray = focal_length * rotation[:, 0] + column * rotation[:, 1] + row * rotation[:, 2]
        homography[0, i] = (0.5 - position_m[1] / width_m) * ray[0] - ahead_m / width_m * ray[1]
        homography[1, i] = (0.5 - above_m / height_m) * ray[0] - ahead_m / height_m * ray[2]
        homography[2, i] = ray[0]


@njit(cache=True, nogil=True, error_model="numpy")
def _block_level(homography, column, row, levels):  # type: ignore[no-untyped-def]
    """Return the mip-map level of the block of two by two pixels that holds a pixel."""
    # OpenGL's rows go up, and its blocks' steps start from the lower left pixel.
    column, row = column - column % 2, row - row % 2 + 1
    x = homography[0, 0] * column + homography[0, 1] * row + homography[0, 2]
    y = homography[1, 0] * column + homography[1, 1] * row + homography[1, 2]
    w = homography[2, 0] * column + homography[2, 1] * row + homography[2, 2]
    w_right, w_up = w + homography[2, 0], w - homography[2, 1]
    u, v = x / w, y / w
    height, width = levels[0, 1], levels[0, 2]
    right_u, right_v = (x + homography[0, 0]) / w_right - u, (y + homography[1, 0]) / w_right - v
    up_u, up_v = (x - homography[0, 1]) / w_up - u, (y - homography[1, 1]) / w_up - v
    # Squared lengths in texels; level i is the nearest from sqrt(2) 2^(i - 1) texels on.
    right = (right_u * width) ** 2 + (right_v * height) ** 2
    up = (up_u * width) ** 2 + (up_v * height) ** 2
    i_level, least = 0, 2.0
    while i_level < levels.shape[0] - 1 and max(right, up) >= least:
        i_level += 1
        least *= 4.0
    return i_level


@njit(cache=True, nogil=True)
def _tile_level(homography, left, top, levels):  # type: ignore[no-untyped-def]
    """Return the level of a whole tile, or -1 where its corners have different ones."""
    right, bottom = left + _TILE_PX - 1, top + _TILE_PX - 1
    i_level = _block_level(homography, left, top, levels)
    is_one = (
        (_block_level(homography, right, top, levels) == i_level)
        & (_block_level(homography, left, bottom, levels) == i_level)
        & (_block_level(homography, right, bottom, levels) == i_level)
    )
    return i_level if is_one else -1


@njit(cache=True, nogil=True, error_model="numpy")
def _look(homography, limits_w, first, uv, is_seen):  # type: ignore[no-untyped-def]
    """Fill uv (2, tile) and is_seen (tile,) of a tile's row; return how many pixels see something.

    first: column and row of its first pixel.
    """
    n_seen = 0
    left, row = first
    row_x = homography[0, 1] * row + homography[0, 2]
    row_y = homography[1, 1] * row + homography[1, 2]
    row_w = homography[2, 1] * row + homography[2, 2]
    for i in range(_TILE_PX):
        w = homography[2, 0] * (left + i) + row_w
        u = (homography[0, 0] * (left + i) + row_x) / w
        v = (homography[1, 0] * (left + i) + row_y) / w
        is_inside = (u >= 0.0) & (u <= 1.0) & (v >= 0.0) & (v <= 1.0)
        is_seen[i] = is_inside & (limits_w[0] <= w) & (w <= limits_w[1])
        n_seen += is_seen[i]
        uv[0, i], uv[1, i] = u, v
    return n_seen


@njit(cache=True, nogil=True)
def _sample(uv, span, texture, scratch, greys):  # type: ignore[no-untyped-def]
    """Fill greys (tile,) with the bilinear samples at uv (2, tile); outside, the border goes on.

    span: first and end of the pixels to fill; texture: texels, and one level's offset in them,
    height and width.
    """
    texels, (offset, height, width) = texture[0], texture[1]
    places, shares = scratch
    last_column, last_row = max(width - 2, 0), max(height - 2, 0)
    for i in range(span[0], span[1]):
        x = min(max(uv[0, i] * width - 0.5, 0.0), width - 1.0)
        y = min(max(uv[1, i] * height - 0.5, 0.0), height - 1.0)
        column, row = min(int32(x), last_column), min(int32(y), last_row)
        places[i] = offset + row * width + column
        shares[0, i], shares[1, i] = x - column, y - row
    # Unsigned, so that numba does not provide for negative indices.
    right, below = np.uint64(width > 1), np.uint64(width if height > 1 else 0)
    for i in range(span[0], span[1]):
        top_place = np.uint64(places[i])
        low_place = top_place + below
        top, top_right = float32(texels[top_place]), float32(texels[top_place + right])
        low, low_right = float32(texels[low_place]), float32(texels[low_place + right])
        top += (top_right - top) * shares[0, i]
        low += (low_right - low) * shares[0, i]
        greys[i] = uint8(top + (low - top) * shares[1, i] + float32(0.5))


@njit(cache=True, nogil=True)
def _level_of(texture, i_level):  # type: ignore[no-untyped-def]
    """Return one level of a texture as _sample takes it."""
    largest, texels, levels = texture
    size = levels[i_level, 0], levels[i_level, 1], levels[i_level, 2]
    return (largest if i_level == 0 else texels), size


@njit(
    void(
        uint8[:, ::1],
        types.UniTuple(int64, 2),
        float64[:, :, ::1],
        float64[:, ::1],
        types.UniTuple(_TEXTURE, 2),
    ),
    cache=True,
    nogil=True,
)
def cast_rays(
    picture: NDArray[np.uint8],
    origin_px: tuple[int, int],
    homographies: Floats,
    limits_w: Floats,
    textures: tuple[tuple[NDArray[np.uint8], NDArray[np.uint8], NDArray[np.int64]], ...],
) -> None:
    """Draw one eye's picture (height, width), whose top left pixel is at origin_px (column, row).

    homographies (2, 3, 3), limits_w (2, 2), textures (2): of the plane, which is nearer, and of the
    landscape. w below the first limit is too far to be drawn, above the second too near; what sees
    neither surface is black. Each texture is eye_plant.camera.texels.Texture.arrays. A pixel's grey
    does not depend on what else is drawn.
    """
    height, width = picture.shape
    left_px, top_px = origin_px
    plane, landscape = homographies[0], homographies[1]
    plane_texture, landscape_texture = textures
    plane_levels, landscape_levels = plane_texture[2], landscape_texture[2]
    uv, is_seen = np.empty((2, _TILE_PX)), np.empty(_TILE_PX, bool_)
    far_uv, is_far_seen = np.empty((2, _TILE_PX)), np.empty(_TILE_PX, bool_)
    greys = np.empty(_TILE_PX, uint8)
    scratch = np.empty(_TILE_PX, int64), np.empty((2, _TILE_PX), float32)
    for top in range(top_px - top_px % _TILE_PX, top_px + height, _TILE_PX):
        for left in range(left_px - left_px % _TILE_PX, left_px + width, _TILE_PX):
            i_plane = _tile_level(plane, left, top, plane_levels)
            i_landscape = _tile_level(landscape, left, top, landscape_levels)
            for row in range(max(top, top_px), min(top + _TILE_PX, top_px + height)):
                n_seen = _look(plane, limits_w[0], (left, row), uv, is_seen)
                n_far_seen = 0
                if n_seen < _TILE_PX:
                    n_far_seen = _look(landscape, limits_w[1], (left, row), far_uv, is_far_seen)
                if n_seen == _TILE_PX and i_plane >= 0:
                    texture = _level_of(plane_texture, i_plane)
                    _sample(uv, (0, _TILE_PX), texture, scratch, greys)
                elif n_seen == 0 and n_far_seen == _TILE_PX and i_landscape >= 0:
                    texture = _level_of(landscape_texture, i_landscape)
                    _sample(far_uv, (0, _TILE_PX), texture, scratch, greys)
                else:
                    for i in range(_TILE_PX):
                        if is_seen[i]:
                            i_level = _block_level(plane, left + i, row, plane_levels)
                            texture = _level_of(plane_texture, i_level)
                            _sample(uv, (i, i + 1), texture, scratch, greys)
                        elif is_far_seen[i]:
                            i_level = _block_level(landscape, left + i, row, landscape_levels)
                            texture = _level_of(landscape_texture, i_level)
                            _sample(far_uv, (i, i + 1), texture, scratch, greys)
                        else:
                            greys[i] = 0
                for i in range(max(left, left_px), min(left + _TILE_PX, left_px + width)):
                    picture[row - top_px, i - left_px] = greys[i - left]
