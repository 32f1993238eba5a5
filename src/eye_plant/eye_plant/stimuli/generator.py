"""Grey pictures in place of photographs, drawn from a seed (D8).

Each picture is a dead-leaves world: opaque shapes whose sizes follow a power law occlude one
another, which gives edges at all scales and an amplitude spectrum that falls about as 1/f, as in
photographs (Lee, Mumford & Huang 2001, "Occlusion models for natural images"). What people build is
straight and repeats itself: so many shapes are upright rectangles, and between them stand panels of
rows and columns (facades, bricks, fences, blinds). Every surface carries 1/f texture of its own
strength, and light falls unevenly.
"""

from dataclasses import dataclass

import cv2
import numpy as np

from eye_plant.stimuli.noise import octaves_noise
from lockstep import generator

# Lengths are for pictures of this size and scale with it.
_REFERENCE_PX = 1920
_LARGEST_LEAF_PX = 500.0  # half its extent
_DARKEST, _BRIGHTEST = 8.0, 245.0
_FIXED_POINT_BITS = 3  # cv2 takes vertices in eighths of a pixel
_N_DISC_VERTICES = 14


@dataclass(frozen=True)
class _Style:
    """What the shapes of one picture have in common."""

    smallest_leaf_px: float  # half its extent
    coverage: float  # the leaves' areas over the picture's area
    upright_share: float
    n_panels: int
    texture_grey: float  # median standard deviation of the texture
    luminance_grey: np.ndarray  # (16, 16), mean grey level of the shapes in each part
    contrast_grey: float  # standard deviation of the shapes' grey levels about it


@dataclass(frozen=True)
class _Shapes:
    """Polygons in painting order; values are what they set on the canvas.

    Canvas channels: grey level, texture strength, mix of the two textures, each 0 to 255.
    """

    vertices: list[np.ndarray]  # (n_vertices, 2) int32, x and y in eighths of a pixel
    values: list[tuple[int, int, int]]


def generate_stimulus(seed: int, role: str, number: int, size_px: int) -> np.ndarray:
    """Return picture `number` of the set `role`, (size_px, size_px) uint8.

    A function of its arguments: pictures of other numbers or roles share no draw with it.
    """
    random = generator(seed, f"{role} stimulus", number)
    scale = size_px / _REFERENCE_PX
    style = _draw_style(random)
    canvas = np.empty((size_px, size_px, 3), np.uint8)
    canvas[:] = _surface_values(random, style, np.array([[0.5, 0.5]]))[0]
    leaves = _draw_leaves(random, style, size_px)
    starts = np.sort(random.integers(0, len(leaves.values) + 1, style.n_panels))
    ends = [*starts[1:], len(leaves.values)]
    _paint(canvas, leaves, 0, int(starts[0]))
    for start, end in zip(starts, ends, strict=True):
        panel = _draw_panel(random, style, size_px)
        _paint(canvas, panel, 0, len(panel.values))
        _paint(canvas, leaves, int(start), int(end))
    _paint_lines(random, style, canvas, scale)
    return _lit_and_textured(random, canvas)


def _draw_style(random: np.random.Generator) -> _Style:
    return _Style(
        smallest_leaf_px=_log_uniform(random, 3.0, 12.0),
        coverage=random.uniform(1.5, 4.0),
        upright_share=random.uniform(0.4, 0.9),
        n_panels=int(random.integers(10, 40)),
        texture_grey=_log_uniform(random, 8.0, 22.0),
        luminance_grey=random.uniform(90.0, 140.0) + 42.0 * octaves_noise(random, 16),
        contrast_grey=random.uniform(25.0, 45.0),
    )


def _draw_leaves(random: np.random.Generator, style: _Style, size_px: int) -> _Shapes:
    """Return leaves of half extent r with density r^-3: each octave covers the same area.

    Larger ones tend to be painted a little earlier, so that small ones are details on them.
    """
    scale = size_px / _REFERENCE_PX
    smallest, largest = style.smallest_leaf_px * scale, _LARGEST_LEAF_PX * scale
    steepness = smallest**-2 - largest**-2
    mean_square = 2.0 * np.log(largest / smallest) / steepness
    n_leaves = int(style.coverage * size_px**2 / (3.0 * mean_square))
    radius = (smallest**-2 - random.uniform(size=n_leaves) * steepness) ** -0.5
    painted_at = random.uniform(size=n_leaves) - 0.04 * np.log2(radius / smallest)
    radius = radius[np.argsort(painted_at)]
    centre = random.uniform(-0.05, 1.05, (n_leaves, 2)) * size_px
    stretch = np.exp(random.normal(0.0, 0.8, n_leaves))
    angle = _draw_angles(random, style, n_leaves)
    outline = random.choice(4, n_leaves, p=[0.6, 0.1, 0.1, 0.2])
    half_extent = np.column_stack((radius * np.sqrt(stretch), radius / np.sqrt(stretch)))
    vertices = [
        _placed(_OUTLINES[outline[i]], half_extent[i], angle[i], centre[i]) for i in range(n_leaves)
    ]
    return _Shapes(vertices, _surface_values(random, style, centre / size_px))


def _draw_panel(random: np.random.Generator, style: _Style, size_px: int) -> _Shapes:
    """Return a rectangle with rows and columns of smaller ones in it."""
    scale = size_px / _REFERENCE_PX
    half_extent = np.array([_log_uniform(random, 40.0, 450.0) for _ in range(2)]) * scale
    pitch = np.array([_log_uniform(random, 14.0, 150.0) for _ in range(2)]) * scale
    n_columns, n_rows = np.clip(2.0 * half_extent / pitch, 1, 24).astype(int)
    if random.uniform() < 0.25:  # bars: a fence or blinds
        n_columns, n_rows = (n_columns, 1) if random.uniform() < 0.7 else (1, n_rows)
    fill = random.uniform(0.35, 0.95, 2)
    angle = _draw_angles(random, style, 1)[0]
    centre = random.uniform(0.0, 1.0, 2) * size_px
    column, row = np.meshgrid(np.arange(n_columns), np.arange(n_rows))
    stagger = 0.5 * (row % 2) * (random.uniform() < 0.3)  # as bricks
    cells = np.column_stack(((column + stagger).ravel(), row.ravel()))
    counts = np.array([n_columns, n_rows])
    cell_centres = (2.0 * cells + 1.0) / counts - 1.0  # in units of the panel's half extent
    vertices = [_placed(_SQUARE, half_extent, angle, centre)]
    for cell_centre in cell_centres:
        square = cell_centre + _SQUARE * fill / counts
        vertices.append(_placed(square, half_extent, angle, centre))
    wall, cell = _surface_values(random, style, np.stack((centre, centre)) / size_px)
    varied = cell[0] + random.normal(0.0, random.uniform(0.0, 30.0), len(cells))
    greys = np.clip(varied, _DARKEST, _BRIGHTEST).astype(int)
    return _Shapes(vertices, [wall, *((int(grey), cell[1], cell[2]) for grey in greys)])


def _draw_angles(random: np.random.Generator, style: _Style, n: int) -> np.ndarray:
    """Return angles (n,) in radians: a share close to upright, the others any."""
    upright = random.normal(0.0, np.radians(2.0), n)
    is_upright = random.uniform(size=n) < style.upright_share
    return np.where(is_upright, upright, random.uniform(0.0, np.pi, n))


def _surface_values(
    random: np.random.Generator, style: _Style, where: np.ndarray
) -> list[tuple[int, int, int]]:
    """Return canvas values of surfaces at where (n, 2), x and y from 0 to 1.

    Grey is the surroundings' luminance with a deviation of its own, since what stands together is
    often alike; texture strength is log-normal, its mix uniform.
    """
    n = len(where)
    n_parts = len(style.luminance_grey)
    column, row = np.clip(where * n_parts, 0, n_parts - 1).astype(int).T
    deviation = style.contrast_grey * random.normal(size=n)
    grey = np.clip(style.luminance_grey[row, column] + deviation, _DARKEST, _BRIGHTEST)
    strength = np.clip(4.0 * style.texture_grey * np.exp(random.normal(0.0, 0.6, n)), 0.0, 255.0)
    mix = random.uniform(0.0, 255.0, n)
    return list(zip(*(c.astype(int).tolist() for c in (grey, strength, mix)), strict=True))


def _placed(
    outline: np.ndarray, half_extent: np.ndarray, angle_rad: float, centre: np.ndarray
) -> np.ndarray:
    """Return outline (n, 2) stretched, turned and moved, in cv2's fixed-point vertices."""
    cosine, sine = np.cos(angle_rad), np.sin(angle_rad)
    turned = (outline * half_extent) @ np.array([[cosine, sine], [-sine, cosine]])
    return np.rint((turned + centre) * 2**_FIXED_POINT_BITS).astype(np.int32)


def _paint(canvas: np.ndarray, shapes: _Shapes, start: int, end: int) -> None:
    for i in range(start, end):
        cv2.fillConvexPoly(
            canvas, shapes.vertices[i], shapes.values[i], cv2.LINE_8, _FIXED_POINT_BITS
        )


def _paint_lines(
    random: np.random.Generator, style: _Style, canvas: np.ndarray, scale: float
) -> None:
    """Paint poles, wires and branches: long thin lines, most of them about upright."""
    n_lines = int(random.integers(5, 40))
    middle = random.uniform(0.0, 1.0, (n_lines, 2))
    values = _surface_values(random, style, middle)
    angle = _draw_angles(random, style, n_lines) + np.pi / 2.0
    direction = np.column_stack((np.cos(angle), np.sin(angle)))
    for i in range(n_lines):
        half = _log_uniform(random, 60.0, 1500.0) * scale * direction[i]
        thickness_px = max(1, round(_log_uniform(random, 2.0, 24.0) * scale))
        centre_px = middle[i] * canvas.shape[0]
        ends = np.rint([centre_px - half, centre_px + half]).astype(int).tolist()
        cv2.line(canvas, ends[0], ends[1], values[i], thickness_px)


def _lit_and_textured(random: np.random.Generator, canvas: np.ndarray) -> np.ndarray:
    """Return the picture (size, size) uint8 that the canvas (size, size, 3) describes.

    grey + strength / 4 * texture, where texture has unit variance and is a mix of two; then light
    that varies slowly by about a quarter, and a lens's slight blur.
    """
    size_px = canvas.shape[0]
    strength = canvas[:, :, 1].astype(np.float32) * np.float32(0.25)
    mix = canvas[:, :, 2].astype(np.float32) * np.float32(1.0 / 255.0)
    first = octaves_noise(random, size_px)
    second = _streaks(octaves_noise(random, size_px))
    picture = second + mix * (first - second)
    picture *= strength
    picture += canvas[:, :, 0]
    light = cv2.resize(octaves_noise(random, 16), (size_px, size_px), interpolation=cv2.INTER_CUBIC)
    picture *= 1.0 + 0.25 * light
    picture = cv2.GaussianBlur(picture, (0, 0), 0.6)
    return np.clip(picture, 0.0, 255.0).astype(np.uint8)


def _streaks(noise: np.ndarray) -> np.ndarray:
    """Return noise (size, size) four times as long as wide, upright: grain, bark, curtains."""
    size_px = noise.shape[0]
    top = noise[: max(1, size_px // 4)]
    streaks = cv2.resize(top, (size_px, size_px), interpolation=cv2.INTER_LINEAR)
    return (streaks - streaks.mean()) / streaks.std()


def _log_uniform(random: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(random.uniform(np.log(low), np.log(high))))


def _disc(n_vertices: int) -> np.ndarray:
    angle = np.arange(n_vertices) * (2.0 * np.pi / n_vertices)
    return np.column_stack((np.cos(angle), np.sin(angle)))


_SQUARE = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
_OUTLINES = (_SQUARE, _disc(3), _disc(6), _disc(_N_DISC_VERTICES))
