"""Shaded pictures of surfaces by a depth buffer, in parallel projection."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from bladewright.numerics.elementary import cumulative_length
from bladewright.nurbs.basis import Reals

Pixels = NDArray[np.float32]
"""Values of pixels or points in single precision, which is more than 8 bits a colour need."""
STEP = 0.7
"""Largest distance between neighbouring points [pixels]. No pixel is missed up to half the root of two, the radius of a
pixel's circumcircle."""
TILE = 8
"""Cells along each side of the tiles that a grid is filled by. Smaller tiles adapt better to steps of different size;
larger ones need fewer calls."""
LIGHTS = (((-0.45, 0.65, 0.60), 0.52), ((0.85, 0.25, 0.45), 0.20), ((0.0, 0.0, 1.0), 0.24))
"""Directions (the viewer's right, up and towards) and strengths of the lamps: the main light from the upper left, a
fill light from the right and one from the viewer, so that no side is black. Chosen by eye."""
AMBIENT, GLOSS, SHARPNESS = 0.36, 0.16, 28.0
"""Light from everywhere, strength of highlights and their exponent in Blinn's model (1977) [-]. Chosen by eye."""
HAZE = 0.30
"""Fraction by which the farthest point fades to white, which shows depth. Chosen by eye."""
HOLLOW = 0.40
"""Largest fraction by which a place is darkened that lies behind its surroundings. Chosen by eye."""
PANE = 0.14
"""Opacity of a see-through surface [-]. Chosen by eye: more hides the blade, less hides the surface."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ShadedGrid:
    """A surface in one colour (red, green, blue): points (m, n, 3) with normals (m, n, 3) of either sense."""

    points: Reals
    normals: Reals
    colour: tuple[float, float, float]
    side: int = 0
    """+1 to draw it only where its normals point towards the viewer, -1 only where they point away, 0 everywhere"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Polyline:
    """A line through points (n, 3) in one colour, hidden where a surface lies in front of it."""

    points: Reals
    colour: tuple[float, float, float]
    width: int = 1
    """width of the line [pixels]"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Camera:
    """A parallel projection; the rows of `axes` (3, 3) are the viewer's right, up and towards."""

    axes: Reals
    corner: Reals
    """(2,) coordinates, right and up, of the lower left corner of the picture"""
    extent: Reals
    """(2,) width and height of the picture, in the unit of the surfaces"""

    def seen(self, points: Reals) -> Reals:
        """Points (..., 3) in the coordinates right, up and towards."""
        seen: Reals = points @ self.axes.T
        return seen


def axes_towards(eye: tuple[float, float, float], up: tuple[float, float, float]) -> Reals:
    """The axes (3, 3) right, up and towards of a viewer in the direction `eye`."""
    towards = np.array(eye) / np.sqrt(np.sum(np.square(eye)))
    right = np.cross(up, towards)
    right = right / np.sqrt(right @ right)
    return np.stack([right, np.cross(towards, right), towards])


def framing_camera(axes: Reals, points: Reals, margin: float = 0.03) -> Camera:
    """A camera whose picture just holds points (n, 3), with a margin in fractions of its longer side."""
    flat = points @ axes[:2].T
    low, high = flat.min(axis=0), flat.max(axis=0)
    border = margin * np.max(high - low)
    return Camera(axes=axes, corner=low - border, extent=high - low + 2.0 * border)


def rendered(
    surfaces: list[ShadedGrid],
    lines: list[Polyline],
    camera: Camera,
    width: int,
    fineness: int = 2,
    glass: Sequence[ShadedGrid] = (),
) -> Reals:
    """The picture (height, width, 4) in red, green, blue and opacity, its first row on top.

    Every pixel is the mean of `fineness` x `fineness` smaller ones. The surfaces of `glass` hide nothing; the nearest
    of them tints what lies behind it.
    """
    across = width * fineness
    unit = across / camera.extent[0]
    height = int(np.ceil(camera.extent[1] * unit / fineness)) * fineness
    depth, normal, colour = _depth_buffer(surfaces, camera, (height, across), unit)
    shaded = _shaded(depth, normal, colour, fineness)
    if glass:
        pane = _depth_buffer(glass, camera, (height, across), unit)
        _overlay_glass(shaded, _shaded(*pane, fineness), pane[0] > depth)
    for line in lines:
        _draw_polyline(shaded, depth, line, camera, unit)
    blocks = shaded[::-1].reshape(height // fineness, fineness, width, fineness, 4)
    blocks[..., :3] *= blocks[..., 3:]
    picture = blocks.mean(axis=(1, 3), dtype=np.float64)
    solid = picture[..., 3:] > 0.0
    picture[..., :3] = np.where(solid, picture[..., :3] / np.where(solid, picture[..., 3:], 1.0), 1.0)
    return np.clip(picture, 0.0, 1.0)


def _depth_buffer(
    surfaces: Sequence[ShadedGrid], camera: Camera, size: tuple[int, int], unit: float
) -> tuple[Pixels, Pixels, Pixels]:
    """Depth (height, width) of the nearest points, with their normals and colours (height * width, 3)."""
    height, across = size
    depth = np.full(across * height, -np.inf, dtype=np.float32)
    normal = np.zeros((across * height, 3), dtype=np.float32)
    colour = np.ones((across * height, 3), dtype=np.float32)
    for surface in surfaces:
        seen = camera.seen(surface.points)
        seen[..., :2] = (seen[..., :2] - camera.corner) * unit
        for points in _dense_tiles(np.concatenate([seen, camera.seen(surface.normals)], axis=-1).astype(np.float32)):
            column, row = points[:, 0].astype(np.int32), points[:, 1].astype(np.int32)
            inside = (points[:, 0] >= 0.0) & (points[:, 1] >= 0.0) & (column < across) & (row < height)
            if surface.side:
                inside &= surface.side * points[:, 5] > 0.0
            pixel = np.where(inside, row * across + column, 0)
            near = np.where(inside, points[:, 2], -np.inf)
            np.maximum.at(depth, pixel, near)
            nearest = np.flatnonzero(inside & (near >= depth[pixel]))
            normal[pixel[nearest]] = points[nearest, 3:]
            colour[pixel[nearest]] = surface.colour
    return depth.reshape(height, across), normal, colour


def _overlay_glass(picture: Pixels, pane: Pixels, in_front: NDArray[np.bool_]) -> None:
    """Blend a shaded see-through surface over the picture where it lies in front."""
    cover = PANE * (pane[..., 3] * in_front)[..., None]
    behind = (1.0 - cover) * picture[..., 3:]
    total = cover + behind
    mixed = cover * pane[..., :3] + behind * picture[..., :3]
    picture[..., :3] = np.where(total > 0.0, mixed / np.where(total > 0.0, total, 1.0), picture[..., :3])
    picture[..., 3:] = total


def _dense_tiles(grid: Pixels) -> Iterator[Pixels]:
    """Points with normals (k, 6) of a grid (m, n, 6), tile by tile, interpolated until no pixel is missed."""
    for row in range(0, grid.shape[0] - 1, TILE):
        for column in range(0, grid.shape[1] - 1, TILE):
            tile = grid[row : row + TILE + 1, column : column + TILE + 1]
            for axis in (0, 1):
                steps = np.diff(tile[..., :2], axis=axis)
                longest = np.sqrt(np.max(np.sum(steps**2, axis=-1), axis=1 - axis))
                count = np.ceil(longest / STEP).astype(int).clip(1)
                index = np.repeat(np.arange(len(count)), count)
                share = (np.arange(len(index)) - np.repeat(np.cumsum(count) - count, count)) / count[index]
                index, share = np.append(index, len(count) - 1), np.append(share, 1.0).astype(np.float32)
                share = share[:, None, None] if axis == 0 else share[:, None]
                start = np.take(tile, index, axis=axis)
                tile = start + share * (np.take(tile, index + 1, axis=axis) - start)
            yield tile.reshape(-1, tile.shape[-1])


def _shaded(depth: Pixels, normal: Pixels, colour: Pixels, fineness: int) -> Pixels:
    """Red, green, blue and opacity (height, width, 4) by Blinn's model (1977), with haze and darkened hollows."""
    covered = np.isfinite(depth)
    picture = np.zeros((*depth.shape, 4), dtype=np.float32)
    if not covered.any():
        return picture
    towards = normal[covered.ravel()]
    towards /= np.maximum(np.sqrt(np.sum(towards**2, axis=-1, keepdims=True)), 1e-12)
    towards *= np.where(towards[:, 2:] < 0.0, -1.0, 1.0)
    light = np.full(len(towards), AMBIENT, dtype=np.float32)
    shine = np.zeros_like(light)
    for direction, strength in LIGHTS:
        lamp = np.array(direction) / np.sqrt(np.sum(np.square(direction)))
        half = lamp + np.array([0.0, 0.0, 1.0])
        light += strength * np.maximum(towards @ lamp, 0.0)
        shine += strength * np.maximum(towards @ (half / np.sqrt(half @ half)), 0.0) ** SHARPNESS
    near, far = depth[covered].max(), depth[covered].min()
    depth_range = max(float(near - far), 1e-30)
    filled = np.where(covered, depth, far)
    hollow = gaussian_filter(filled, 0.008 * max(depth.shape) / fineness * 2.0) - filled
    light *= 1.0 - HOLLOW * np.clip(4.0 * hollow[covered] / depth_range, 0.0, 1.0)
    base = colour[covered.ravel()] * light[:, None] + GLOSS * shine[:, None]
    haze = HAZE * ((near - depth[covered]) / depth_range)[:, None]
    picture[covered, :3] = np.clip(base, 0.0, 1.0) * (1.0 - haze) + haze
    picture[covered, 3] = 1.0
    return picture


def _draw_polyline(picture: Pixels, depth: Pixels, line: Polyline, camera: Camera, unit: float) -> None:
    """Draw a line into the picture where it is nearer than the depth there, but for a bias of three line widths."""
    seen = camera.seen(line.points)
    seen[:, :2] = (seen[:, :2] - camera.corner) * unit
    along = cumulative_length(seen[:, :2])
    at = np.linspace(0.0, along[-1], int(2.0 * along[-1]) + 2)
    right, up, towards = (np.interp(at, along, seen[:, i]) for i in range(3))
    bias = 3.0 * line.width / unit
    offsets = np.arange(line.width) - (line.width - 1) // 2
    for across in offsets:
        for above in offsets:
            column, row = (right + across).astype(int), (up + above).astype(int)
            inside = (column >= 0) & (row >= 0) & (column < depth.shape[1]) & (row < depth.shape[0])
            column, row, near = column[inside], row[inside], towards[inside]
            ahead = near + bias > depth[row, column]
            picture[row[ahead], column[ahead]] = (*line.colour, 1.0)
