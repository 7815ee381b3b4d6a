"""A first design from a cloud of points: its channel from four rough corners, camber and thickness from averages.

The cloud needs no rows and no order. Its meridional outline is found in the coordinates of a channel that starts
rough; the mean of all tangential positions, as a smooth function of the channel's coordinates, is the camber.
"""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev
from scipy.spatial import cKDTree

from bladewright.nurbs.basis import Reals, basis, uniform_knots
from bladewright.section.laws import law_basis

EDGES = ("hub", "shroud", "leading_edge", "trailing_edge")


@dataclass(frozen=True, kw_only=True)
class Outline:
    """Four meridional curves, control points (n, 2) in (x, r) with shared corners, and the cloud in their (u, v)."""

    curves: dict[str, Reals]
    u: Reals
    v: Reals

    def position(self, u: Reals, v: Reals) -> Reals:
        """(x, r) of the transfinite interpolation at u and v of one shape."""
        return _position(self.curves, u, v)


def outline(places: Reals, hub: Reals, shroud: Reals, counts: dict[str, int], turns: int = 8) -> Outline:
    """The meridional outline of places (n, 2).

    `hub` and `shroud` (k, 2) are rough polylines from leading to trailing edge: two corners where a wall does not
    bend much, snapped to the nearest place; `counts` control points of each curve. Each turn puts the outermost places
    of the cloud on the curves between the corners.
    """
    tree = cKDTree(places)
    walls = [np.array(rough, dtype=float) for rough in (hub, shroud)]
    for wall in walls:
        wall[[0, -1]] = places[tree.query(wall[[0, -1]])[1]]
    ends = [np.array([wall[i] for wall in walls]) for i in (0, -1)]
    curves = {name: _through(rough, counts[name]) for name, rough in zip(EDGES, (*walls, *ends), strict=True)}
    for _ in range(turns):
        u, v = _inverse(curves, places)
        fitted = {}
        for name in EDGES:
            along, across = (u, v) if name in ("hub", "shroud") else (v, u)
            outer = _outermost(along, across, high=name in ("shroud", "trailing_edge"))
            fitted[name] = _fitted(places[outer], along[outer], curves[name])
        curves = fitted
    u, v = _inverse(curves, places)
    return Outline(curves=curves, u=u, v=v)


def wall_places(found: Outline, places: Reals, width: float = 0.01, reach: float = 0.04) -> dict[str, Reals]:
    """The cloud's places on hub and shroud, within `width` of the span, and its outermost near both edges."""
    result = {"hub": places[found.v < width], "shroud": places[found.v > 1.0 - width]}
    for edge, end in (("leading_edge", 0.0), ("trailing_edge", 1.0)):
        outer = _outermost(found.v, found.u, high=bool(end), share=1e-6)
        result[edge] = places[outer[np.abs(found.u[outer] - end) < reach]]
    return result


@dataclass(frozen=True, kw_only=True)
class Camber:
    """First values of the laws."""

    theta: tuple[float, ...]
    """position of the leading edge, in the unit of the ordinate"""
    stagger: tuple[float, ...]
    angle_in: tuple[float, ...]
    angle_out: tuple[float, ...]
    thickness: float
    """mean half thickness of the meridional length"""


def first_camber(found: Outline, tangential: Reals, annular: bool, count: int, along_v: int = 3) -> Camber:
    """Laws with `count` control points from tangential positions (n,), theta [rad] or y [m], of the cloud.

    Angles in degrees. `along_v` is the degree in v of the polynomial that is the camber.
    """
    u, v = (2.0 * np.clip(a, 0.0, 1.0) - 1.0 for a in (found.u, found.v))
    vander = chebyshev.chebvander2d(u, v, [3, along_v])
    c, *_ = np.linalg.lstsq(vander, tangential, rcond=None)
    field = c.reshape(4, along_v + 1)
    span, chord = np.linspace(0.0, 1.0, 21), np.linspace(0.0, 1.0, 201)
    place = found.position(*np.meshgrid(chord, span, indexing="xy"))
    step = np.linalg.norm(np.diff(place, axis=1), axis=-1)
    middle = (place[:, 1:, 1] + place[:, :-1, 1]) / 2.0
    abscissa = np.concatenate([np.zeros((21, 1)), np.cumsum(step / (middle if annular else 1.0), axis=1)], axis=1)
    camber = chebyshev.chebgrid2d(2 * chord - 1, 2 * span - 1, field).T
    slope = np.gradient(camber, axis=1) / np.gradient(abscissa, axis=1)
    angles = {
        "angle_in": slope[:, 10], "angle_out": slope[:, -11],
        "stagger": (camber[:, -1] - camber[:, 0]) / abscissa[:, -1],
    }  # fmt: skip
    length = np.sum(step, axis=1).mean()
    radius = np.mean(place[..., 1]) if annular else 1.0
    turned = np.cos(np.arctan(np.median(slope)))
    laws = {name: _law(np.degrees(np.arctan(value)), span, count) for name, value in angles.items()}
    return Camber(
        theta=_law(np.degrees(camber[:, 0]) if annular else camber[:, 0], span, count),
        thickness=float(np.median(np.abs(tangential - vander @ c)) * radius * turned / length),
        **laws,
    )


def _law(values: Reals, v: Reals, count: int) -> tuple[float, ...]:
    found, *_ = np.linalg.lstsq(law_basis(count, v), values, rcond=None)
    return tuple(float(x) for x in found)


def _through(rough: Reals, count: int) -> Reals:
    """Control points of a curve along a polyline, by its arc length."""
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(rough, axis=0), axis=-1))])
    t = np.linspace(0.0, 1.0, 41)
    places = np.stack([np.interp(t * way[-1], way, rough[:, i]) for i in (0, 1)], axis=-1)
    return _fitted(places, t, np.linspace(rough[0], rough[-1], count))


def _position(curves: dict[str, Reals], u: Reals, v: Reals) -> Reals:
    hub, shroud, leading, trailing = (
        _curve(curves[name], along.ravel()).reshape(*along.shape, 2)
        for name, along in zip(EDGES, (u, u, v, v), strict=True)
    )
    a, b = curves["leading_edge"][[0, -1]]
    c, d = curves["trailing_edge"][[0, -1]]
    u, v = u[..., None], v[..., None]
    ruled = (1 - u) * (1 - v) * a + (1 - u) * v * b + u * (1 - v) * c + u * v * d
    return (1 - v) * hub + v * shroud + (1 - u) * leading + u * trailing - ruled


def _curve(points: Reals, t: Reals) -> Reals:
    degree = min(len(points) - 1, 5)
    return basis(uniform_knots(len(points), degree), degree, t) @ points


def _inverse(curves: dict[str, Reals], places: Reals) -> tuple[Reals, Reals]:
    grid = np.linspace(-0.15, 1.15, 131)
    u, v = np.meshgrid(grid, grid, indexing="ij")
    _, index = cKDTree(_position(curves, u, v).reshape(-1, 2)).query(places)
    u, v = u.ravel()[index], v.ravel()[index]
    for _ in range(6):
        h = 1e-5
        miss = places - _position(curves, u, v)
        du = (_position(curves, u + h, v) - _position(curves, u - h, v)) / (2 * h)
        dv = (_position(curves, u, v + h) - _position(curves, u, v - h)) / (2 * h)
        det = du[:, 0] * dv[:, 1] - du[:, 1] * dv[:, 0]
        u = np.clip(u + np.clip((miss[:, 0] * dv[:, 1] - miss[:, 1] * dv[:, 0]) / det, -0.05, 0.05), -0.3, 1.3)
        v = np.clip(v + np.clip((du[:, 0] * miss[:, 1] - du[:, 1] * miss[:, 0]) / det, -0.05, 0.05), -0.3, 1.3)
    return u, v


def _outermost(along: Reals, across: Reals, *, high: bool, window: float = 0.04, share: float = 0.01) -> Reals:
    """Indices of the places within `share` of the outermost of their neighbours along a curve."""
    value = -across if high else across
    least = np.array([np.min(value[np.abs(along - at) < window]) for at in along])
    keep = value <= least + share
    middle = np.median(value[keep])
    return np.flatnonzero(keep & (np.abs(value - middle) < 0.2))


def _fitted(places: Reals, t: Reals, before: Reals) -> Reals:
    """Control points of the least-squares curve with the ends of the one before."""
    count = len(before)
    degree = min(count - 1, 5)
    if count == 2:
        return before
    rows = basis(uniform_knots(count, degree), degree, np.clip(t, 0.0, 1.0))
    tame = 1e-2 * np.sqrt(len(t)) * np.eye(count - 2)
    aim = places - rows[:, [0, -1]] @ before[[0, -1]]
    aim = np.concatenate([aim, tame @ before[1:-1]])
    inner, *_ = np.linalg.lstsq(np.concatenate([rows[:, 1:-1], tame]), aim, rcond=None)
    return np.concatenate([before[:1], inner, before[-1:]])
