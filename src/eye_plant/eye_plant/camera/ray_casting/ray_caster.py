"""Rays from an eye's pixels to two textured rectangles that face it, in compiled loops.

A pixel at column c and row r of the full picture sees the texture coordinates (u, v) = (x, y) / w,
where (x, y, w) = H (c, r, 1): a plane through a pinhole is a homography H. (0, 0) is the texture's
top left corner, (1, 1) its bottom right one, and w is the ray's step along the world's x axis.

Textures are sampled as by OpenGL's GL_LINEAR_MIPMAP_NEAREST: one ray through each pixel's centre,
one bilinear sample from the mip-map level that is nearest to the longer of the steps in texture
coordinates between the pixels of a block of two by two (OpenGL 4.5 specification, section 8.14).
"""

from typing import Any

import numpy as np
from numba import float32, float64, int32, int64, njit, types, uint8, void
from numpy.typing import NDArray

Floats = NDArray[np.float64]

# A tile is drawn at once where it can be, else in parts; both hold whole blocks of two by two.
_TILE_WIDTH_PX, _TILE_HEIGHT_PX = 32, 8
_PART_WIDTH_PX = 8
# A tile that sees nothing of a surface, and one that is not all of one level of one surface.
_UNSEEN, _MIXED = -2, -1
# Read-only arrays, such as those mapped from a file, can be passed as well as others.
_TEXELS = types.Array(uint8, 1, "C", readonly=True)
_LEVELS = types.Array(int64, 2, "C", readonly=True)
_TEXTURE = types.Tuple((_TEXELS, _TEXELS, _LEVELS))


@njit(cache=True, nogil=True)
def _find_homography(pose, rectangle_m, lens, homography):  # type: ignore[no-untyped-def]
    """Fill homography (3, 3) of one eye and one rectangle; arguments as those of cast_rays."""
    position_m, rotation = pose
    ahead_m = rectangle_m[0] - position_m[0]
    above_m = position_m[2] - rectangle_m[1]
    width_m, height_m = rectangle_m[2], rectangle_m[3]
    focal_length, column, row = lens[0], lens[1], lens[2]
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


@njit(cache=True, nogil=True, error_model="numpy")
def _look(homography, column, row):  # type: ignore[no-untyped-def]
    """Return u, v and w of a pixel."""
    w = homography[2, 0] * column + (homography[2, 1] * row + homography[2, 2])
    u = (homography[0, 0] * column + (homography[0, 1] * row + homography[0, 2])) / w
    v = (homography[1, 0] * column + (homography[1, 1] * row + homography[1, 2])) / w
    return u, v, w


@njit(cache=True, nogil=True)
def _is_seen(u, v, w, limits_w):  # type: ignore[no-untyped-def]
    is_inside = (u >= 0.0) & (u <= 1.0) & (v >= 0.0) & (v <= 1.0)
    return is_inside & (limits_w[0] <= w) & (w <= limits_w[1])


@njit(cache=True, nogil=True, error_model="numpy")
def _tile_level(homography, limits_w, tile, levels):  # type: ignore[no-untyped-def]
    """Return the level at which all of a tile sees the rectangle; else _UNSEEN or _MIXED.

    tile: left, top, width.

    What a picture shows of the rectangle is convex, so the corners speak for the tile: it sees
    nothing else if they do not, and nothing of it if all of them are beyond the same side.
    """
    n_seen = n_left = n_right = n_above = n_below = n_behind = n_far = n_near = 0
    i_level, is_one_level = 0, True
    for i_corner in range(4):
        column = tile[0] + (i_corner % 2) * (tile[2] - 1)
        row = tile[1] + (i_corner // 2) * (_TILE_HEIGHT_PX - 1)
        u, v, w = _look(homography, column, row)
        n_seen += _is_seen(u, v, w, limits_w)
        n_left, n_right = n_left + (u < 0.0), n_right + (u > 1.0)
        n_above, n_below = n_above + (v < 0.0), n_below + (v > 1.0)
        n_far, n_near = n_far + (w < limits_w[0]), n_near + (w > limits_w[1])
        n_behind += not w > 0.0
        i_corners_level = _block_level(homography, column, row, levels)
        is_one_level &= i_corner == 0 or i_corners_level == i_level
        i_level = i_corners_level
    if n_seen == 4:
        return i_level if is_one_level else _MIXED
    if max(n_far, n_near) == 4:
        return _UNSEEN
    if n_behind == 0 and max(n_left, n_right, n_above, n_below) == 4:
        return _UNSEEN
    return _MIXED


@njit(cache=True, nogil=True)
def _place(u, v, offset, height, width):  # type: ignore[no-untyped-def]
    """Return the place of the top left of four texels around (u, v), and shares of its neighbours.

    Of the right and of the lower one; beyond the border the border goes on. In floating point,
    which has vector instructions for all of it; offset, height and width are whole. OpenCV reads no
    picture of more than 2^30 pixels, so that 32 bits suffice for a place.
    """
    x = min(max(u * width - 0.5, 0.0), width - 1.0)
    y = min(max(v * height - 0.5, 0.0), height - 1.0)
    column, row = (
        min(np.floor(x), max(width - 2.0, 0.0)),
        min(np.floor(y), max(height - 2.0, 0.0)),
    )
    return int32(offset + row * width + column), float32(x - column), float32(y - row)


@njit(cache=True, nogil=True)
def _blend(texels, shares):  # type: ignore[no-untyped-def]
    """Return the bilinear sample, uint8, of four texels: two above, two below."""
    above, below = float32(texels[0]), float32(texels[2])
    above += (float32(texels[1]) - above) * shares[0]
    below += (float32(texels[3]) - below) * shares[0]
    return uint8(above + (below - above) * shares[1] + float32(0.5))


@njit(cache=True, nogil=True, error_model="numpy")
def _draw_tile(homography, tile, level, scratch, greys):  # type: ignore[no-untyped-def]
    """Fill greys (tile,) where all of a tile sees one level: texels, (offset, height, width) there.

    Three loops, of which the first and the last are vector instructions; the other one fetches.
    """
    (left, top, tile_width), (texels, size) = tile, level
    places, shares_x, shares_y, corners = scratch
    offset, height, width = float(size[0]), float(size[1]), float(size[2])
    slope_x, slope_y, slope_w = homography[0, 0], homography[1, 0], homography[2, 0]
    for i_row in range(_TILE_HEIGHT_PX):
        row = float(top + i_row)
        row_x = homography[0, 1] * row + homography[0, 2]
        row_y = homography[1, 1] * row + homography[1, 2]
        row_w = homography[2, 1] * row + homography[2, 2]
        for i_column in range(tile_width):
            column = float(left + i_column)
            w = slope_w * column + row_w
            u, v = (slope_x * column + row_x) / w, (slope_y * column + row_y) / w
            i = i_row * tile_width + i_column
            places[i], shares_x[i], shares_y[i] = _place(u, v, offset, height, width)
    # Unsigned, so that numba does not provide for negative indices.
    right, below = np.uint64(size[2] > 1), np.uint64(size[2] if size[1] > 1 else 0)
    for i in range(_TILE_HEIGHT_PX * tile_width):
        place = np.uint64(places[i])
        corners[0, i], corners[1, i] = texels[place], texels[place + right]
        corners[2, i], corners[3, i] = texels[place + below], texels[place + below + right]
    for i in range(_TILE_HEIGHT_PX * tile_width):
        texels_there = corners[0, i], corners[1, i], corners[2, i], corners[3, i]
        greys[i] = _blend(texels_there, (shares_x[i], shares_y[i]))


@njit(cache=True, nogil=True)
def _sample(u, v, level):  # type: ignore[no-untyped-def]
    """Return one bilinear sample of a level: texels, (offset, height, width) there."""
    texels, (offset, height, width) = level[0], (level[1][0], level[1][1], level[1][2])
    place, share_x, share_y = _place(u, v, float(offset), float(height), float(width))
    right, below = int64(width > 1), int64(width if height > 1 else 0)
    above_texels, low = (texels[place], texels[place + right]), place + below
    return _blend((*above_texels, texels[low], texels[low + right]), (share_x, share_y))


@njit(cache=True, nogil=True)
def _level(texture, i_level):  # type: ignore[no-untyped-def]
    """Return the texels that hold a level, and its offset in them, height and width."""
    return (texture[0] if i_level == 0 else texture[1]), texture[2][i_level]


@njit(cache=True, nogil=True)
def _draw_blocks(surfaces, left, top, greys):  # type: ignore[no-untyped-def]
    """Fill greys (part of a tile,) block by block: of each the level, of each pixel the surface."""
    homographies, limits_w, textures = surfaces
    for i_block in range(_TILE_HEIGHT_PX * _PART_WIDTH_PX // 4):
        column = left + 2 * (i_block % (_PART_WIDTH_PX // 2))
        row = top + 2 * (i_block // (_PART_WIDTH_PX // 2))
        for i in range(4):
            pixel_column, pixel_row = column + i % 2, row + i // 2
            grey = uint8(0)
            for i_surface in range(2):
                homography, texture = homographies[i_surface], textures[i_surface]
                u, v, w = _look(homography, pixel_column, pixel_row)
                if _is_seen(u, v, w, limits_w[i_surface]):
                    i_level = _block_level(homography, column, row, texture[2])
                    grey = _sample(u, v, _level(texture, i_level))
                    break
            greys[(pixel_row - top) * _PART_WIDTH_PX + pixel_column - left] = grey


@njit(cache=True, nogil=True)
def _draws_at_once(surfaces, tile, scratch, greys):  # type: ignore[no-untyped-def]
    """Fill greys (tile,) and return True if a tile is all of one level of one surface, or empty.

    surfaces: homographies, limits of w and textures, the nearer one first; tile: left, top, width.
    """
    homographies, limits_w, textures = surfaces
    for i_surface in range(2):
        homography, texture = homographies[i_surface], textures[i_surface]
        i_level = _tile_level(homography, limits_w[i_surface], tile, texture[2])
        if i_level >= 0:
            _draw_tile(homography, tile, _level(texture, i_level), scratch, greys)
        if i_level != _UNSEEN:
            return i_level >= 0
    greys[:] = 0
    return True


@njit(cache=True, nogil=True)
def _copy(greys, tile, origin_px, picture):  # type: ignore[no-untyped-def]
    """Copy a tile's greys to where they are in the picture, as far as it goes."""
    (left, top, tile_width), (left_px, top_px) = tile, origin_px
    height, width = picture.shape
    for row in range(max(top, top_px), min(top + _TILE_HEIGHT_PX, top_px + height)):
        first = (row - top) * tile_width - left
        for column in range(max(left, left_px), min(left + tile_width, left_px + width)):
            picture[row - top_px, column - left_px] = greys[first + column]


@njit(cache=True, nogil=True)
def _limits_w(position_m, rectangle_m, lens):  # type: ignore[no-untyped-def]
    """Return the least and the greatest w at which a rectangle is drawn."""
    # A ray's depth along the line of sight is F, its step along x is w.
    ahead = (rectangle_m[0] - position_m[0]) * lens[0]
    return ahead / lens[4], ahead / lens[3]


@njit(cache=True, nogil=True)
def _space_for_a_tile():  # type: ignore[no-untyped-def]
    """Return greys (tile,), and the places, shares and texels that drawing them goes through."""
    n_pixels = _TILE_HEIGHT_PX * _TILE_WIDTH_PX
    scratch = (
        np.empty(n_pixels, int32),
        np.empty(n_pixels, float32),
        np.empty(n_pixels, float32),
        np.empty((4, n_pixels), uint8),
    )
    return np.empty(n_pixels, uint8), scratch


@njit(
    void(
        uint8[:, ::1],
        types.UniTuple(int64, 2),
        types.Tuple((float64[:], float64[:, :])),
        types.UniTuple(float64, 5),
        types.Tuple((float64[:, ::1], types.UniTuple(_TEXTURE, 2))),
    ),
    cache=True,
    nogil=True,
)
def cast_rays(
    picture: NDArray[np.uint8],
    origin_px: tuple[int, int],
    pose: tuple[Floats, Floats],
    lens: tuple[float, float, float, float, float],
    surfaces: tuple[Floats, tuple[tuple[NDArray[Any], ...], ...]],
) -> None:
    """Draw one eye's picture (height, width), whose top left pixel is at origin_px (column, row).

    pose: position (3,) and rotation (3, 3) of the eye as StereoCamera.render takes them; lens:
    focal length, column and row of the full picture's centre, px, the least and the greatest depth
    along the line of sight that are drawn, m; surfaces: of the plane, which is nearer, and of the
    landscape distance x, height z of the centre, width and height, m (2, 4), and two textures, each
    a Texture of the module texture_storage. What sees neither surface is black. A pixel's grey does
    not depend on what else is drawn.
    """
    height, width = picture.shape
    left_px, top_px = origin_px
    greys, scratch = _space_for_a_tile()
    rectangles_m, textures = surfaces
    homographies, limits_w = np.empty((2, 3, 3)), np.empty((2, 2))
    for i in range(2):
        _find_homography(pose, rectangles_m[i], lens, homographies[i])
        limits_w[i, 0], limits_w[i, 1] = _limits_w(pose[0], rectangles_m[i], lens)
    seen = homographies, limits_w, textures
    for top in range(top_px - top_px % _TILE_HEIGHT_PX, top_px + height, _TILE_HEIGHT_PX):
        for left in range(left_px - left_px % _TILE_WIDTH_PX, left_px + width, _TILE_WIDTH_PX):
            tile = left, top, _TILE_WIDTH_PX
            if _draws_at_once(seen, tile, scratch, greys):
                _copy(greys, tile, origin_px, picture)
                continue
            for part_left in range(left, left + _TILE_WIDTH_PX, _PART_WIDTH_PX):
                part = part_left, top, _PART_WIDTH_PX
                if not _draws_at_once(seen, part, scratch, greys):
                    _draw_blocks(seen, part_left, top, greys)
                _copy(greys, part, origin_px, picture)
