"""What of a passage wants smaller elements than its open part: the edges of the blade, and the gap at its tip."""

from dataclasses import dataclass

import numpy as np

from bladewright.domain.passage import Passage
from bladewright.numerics.elementary import length
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.closest import closest_on_surface
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.measure import arc_length
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface

WALLS = ("hub", "shroud")


@dataclass(frozen=True, kw_only=True)
class Source:
    """A curve or face that smaller elements grow away from."""

    face: str
    """name of the face; empty for a curve"""
    place: tuple[float, float, float]
    """on it, the middle of a curve [m]"""
    size: float
    """of the elements there [m]"""
    extent: float
    """length [m] of the curve, or area [m^2] of the face"""


def sources(passage: Passage, curvature: float) -> tuple[Source, ...]:
    """The blade's edges, with `curvature` elements on a circle as tight, and its tip, with one across the gap.

    The face of a blunt edge is as fine as a round edge of its width.
    """
    upper, tip = passage.surfaces["blade_upper"], passage.surfaces.get("tip")
    found = []
    for u, name in ((0.0, "blade_leading_edge"), (1.0, "blade_trailing_edge")):
        face = passage.surfaces.get(name)
        if isinstance(face, Surface):
            found.append(_face(name, face, curvature))
        elif isinstance(upper, Surface):
            found.append(_edge(upper, u, curvature))
    if isinstance(tip, TrimmedSurface):
        found.append(_tip(passage, tip))
    return tuple(found)


def _edge(side: Surface, u: float, curvature: float) -> Source:
    line = Curve(control_points=side.control_points[-1 if u else 0].real, knots=side.knots_v, degree=side.degree_v)
    x, y, z = line(0.5).tolist()
    size = 2.0 * np.pi * _radius(side, u) / curvature
    return Source(face="", place=(x, y, z), size=size, extent=float(arc_length(line)))


def _face(name: str, face: Surface, curvature: float) -> Source:
    v = np.linspace(0.0, 1.0, 33)
    first, last = face(0.0, v).real, face(1.0, v).real
    widths, steps = length(last - first), length(np.diff(0.5 * (first + last), axis=0))
    x, y, z = (0.5 * (first + last))[len(v) // 2].tolist()
    area = float(np.sum(0.5 * (widths[1:] + widths[:-1]) * steps))
    return Source(face=name, place=(x, y, z), size=np.pi * float(np.median(widths)) / curvature, extent=area)


def _radius(side: Surface, u: float) -> float:
    """Median over the span of the radius of a side's section at an edge [m]; zero where it is sharp."""
    bends = []
    for v in np.linspace(0.05, 0.95, 10).tolist():
        first, second = (side.derivative(u, v, order, 0).real for order in (1, 2))
        speed = float(length(first))
        bends.append(float(length(np.cross(first, second))) / speed**3 if speed > 0.0 else np.inf)
    bend = float(np.median(bends))
    return 1.0 / bend if bend > 0.0 else np.inf


def _tip(passage: Passage, tip: TrimmedSurface) -> Source:
    runs = [curve(np.linspace(*curve.domain, 17)).real for curve in tip.boundary]
    rim = np.concatenate([tip.surface(*run.T).real for run in runs])
    x, y, z = rim[0].tolist()
    return Source(face="tip", place=(x, y, z), size=_gap(passage, rim), extent=_area(rim))


def _gap(passage: Passage, rim: Reals) -> float:
    """Median distance of points (n, 3) from the nearer wall [m]."""
    sides = [
        [face for name, face in passage.surfaces.items() if name.startswith(wall) and isinstance(face, Surface)]
        for wall in WALLS
    ]
    near = min(sides, key=lambda faces: min(_to_net(face, rim[0]) for face in faces))
    distances = [closest_on_surface(face, rim, tolerance=1e-3).distances.real for face in near]
    return float(np.median(np.min(distances, axis=0)))


def _to_net(face: Surface, point: Reals) -> float:
    return float(length(face.control_points.real - point).min())


def _area(rim: Reals) -> float:
    """Area [m^2] within a closed run of points (n, 3)."""
    ahead = np.roll(rim, -1, axis=0)
    return 0.5 * float(length(np.cross(rim, ahead).sum(axis=0)))
