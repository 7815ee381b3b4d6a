"""A ParaBlade design's meridional channel, cut where its camber lines begin and end.

ParaBlade's sections fill the channel from nose to nose; those of the unified family have their camber from edge to
edge, so the channel's edges are brought to the ends of the camber lines. Bilinear blending keeps its form in that where
the cut is the same along the span.
"""

import numpy as np

from bladewright.blade.channel import Channel
from bladewright.blade.meridional import meridional
from bladewright.designs import Point
from bladewright.files.parablade.config import Config
from bladewright.files.parablade.shape import Shape
from bladewright.nurbs.basis import Reals
from bladewright.section.laws import law_basis

MOST = 12
"""most control points of a curve"""
CLOSE = 2e-5
"""distance of a curve from the one that is meant, of the channel's size, at which no more control points are added"""
_ALONG = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 101))) / 2.0


def cut_channel(config: Config, unit: float) -> tuple[Channel, float]:
    """The channel in a unit of `unit` metres, and the largest distance [m] of its curves from those that are meant."""
    shape = Shape(config=config, v=_ALONG)
    places = shape.channel_places(np.broadcast_to([0.0, 1.0], (len(_ALONG), 2)))
    edges = shape.meridional(places)
    walls = []
    for end in (0, -1):
        at = Shape(config=config, v=_ALONG[[end]])
        walls.append(at.meridional((places[end, 0] + _ALONG * (places[end, 1] - places[end, 0]))[None])[0])
    size = float(np.max(np.ptp(np.concatenate([edges.reshape(-1, 2), *walls]), axis=0)))
    curves, worst = {}, 0.0
    for name, points, axes in (
        ("leading_edge", edges[:, 0], ("leading",)),
        ("trailing_edge", edges[:, 1], ("trailing",)),
        ("hub", walls[0], ("hub",)),
        ("shroud", walls[1], ("shroud",)),
    ):
        inner = name in ("hub", "shroud")
        counts = [len(config.laws[f"{axis}_{axes[0]}"]) + (2 if inner else 0) for axis in "xz"]
        controls, error = _through(points, max(2, *counts), CLOSE * size)
        worst = max(worst, error)
        rows = controls[1:-1] if inner else controls
        curves[name] = tuple(Point(float(x), float(r)) for x, r in rows / unit)
    return Channel(**curves, degree=3), worst


def lengths_of(channel: Channel, unit: float, v: Reals) -> Reals:
    """Meridional lengths (m,) [m] of the channel at v (m,)."""
    nodes, weights = np.polynomial.legendre.leggauss(60)
    along, _ = meridional(channel, unit).slopes((nodes + 1.0) / 2.0, v)
    return np.sqrt(np.sum(np.real(along) ** 2, axis=-1)) @ weights / 2.0


def _through(points: Reals, count: int, close: float) -> tuple[Reals, float]:
    """Control points of the spline that is nearest to points (101, 2) at their parameters, its ends on theirs."""
    while True:
        rows = law_basis(count, _ALONG)
        ends = rows[:, [0, -1]] @ points[[0, -1]]
        inner = np.linalg.lstsq(rows[:, 1:-1], points - ends, rcond=None)[0] if count > 2 else np.empty((0, 2))
        controls = np.concatenate([points[:1], inner, points[-1:]])
        error = float(np.sqrt(np.max(np.sum((rows @ controls - points) ** 2, axis=-1))))
        if error <= close or count == MOST:
            return controls, error
        count += 1
