"""Wheels of closed formulas: a ring under a hub in N trimmed pieces, a blade through a hole of each or of the first."""

from dataclasses import dataclass, field

import numpy as np

from bladewright.nurbs.curve import Curve
from bladewright.nurbs.domain import reversed as run_back
from bladewright.nurbs.mass_properties import mass_properties
from bladewright.nurbs.revolution import LEFT_HANDED, Revolution, revolved, segment
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface

from .closed_forms import HUB, Blade, Promises, annular, doubled, fitted, meridian

BORE = 0.15
"""[m] radius"""
FRONT, BACK = 0.1, 0.9
"""u of the hub's meridian at which the ring begins and ends"""
FINE = doubled(40, 5)


@dataclass(frozen=True, kw_only=True)
class Wheel(Blade):
    edges: tuple[Curve, ...] = ()
    conformance: Promises = field(default_factory=Promises)


def periodic(w: np.ndarray, start: float) -> tuple[np.ndarray, np.ndarray]:
    """The hub's u and theta along the line between two pieces."""
    u = FRONT + (BACK - FRONT) * w
    return u, 0.18 * u * (2.0 - u) - 0.28 + start


def placed(revolution: Revolution, u: np.ndarray, theta: np.ndarray) -> np.ndarray:
    return np.stack(np.broadcast_arrays(u, revolution.v(theta)), axis=-1)


def piece(hub: Curve, turn: float, pitch: float, foot: TrimmedSurface | None) -> tuple[TrimmedSurface, Curve]:
    """The hub between two periodic lines and outside the foot of a blade, and the first line in space."""
    revolution = Revolution(meridian=hub, start=turn - 0.5, end=turn + pitch + 0.1)
    low, high = (fitted(lambda w, at=at: placed(revolution, *periodic(w, at)), FINE) for at in (turn, turn + pitch))
    corners = [curve.control_points[end] for curve in (low, high) for end in (0, -1)]
    boundary = (low, segment(corners[1], corners[3]), run_back(high), segment(corners[2], corners[0]))

    def onto(curve: Curve, own: Revolution) -> Curve:
        def place(w: np.ndarray) -> np.ndarray:
            u, v = curve(w).T
            return placed(revolution, u, own.theta(v))

        return fitted(place, FINE)

    def in_space(w: np.ndarray) -> np.ndarray:
        u, theta = periodic(w, turn)
        x, r = hub(u).T
        return np.stack([x, r * np.sin(theta), r * np.cos(theta)], axis=-1)

    hole = [run_back(onto(curve, foot.revolution)) for curve in foot.boundary[::-1]] if foot else []
    face = TrimmedSurface(
        surface=revolution.surface(),
        boundary=boundary,
        revolution=revolution,
        holes=(tuple(hole),) if hole else (),
    )
    return face, fitted(in_space, FINE)


def ring(count: int = 5, *, blades: int = 1, name: str = "wheel", solid: bool = False, askew: float = 0.0) -> Wheel:
    """A ring of the hub, in pieces of a pitch, two discs and a bore; blades stand through holes of the first pieces.

    With `solid` the ring has no bore, so that its discs end in poles on the axis. The blades are turned by `askew`
    from where they belong.
    """
    pitch, hub = 2.0 * np.pi / count, meridian(HUB)
    surfaces: dict[str, Surface | TrimmedSurface] = {}
    edges, orientations = [], {}
    for number in range(1, count + 1):
        turn, foot = (number - 1) * pitch, None
        if number <= blades:
            own, label = annular(turn=turn + askew).surfaces, f"blade_{number:02d}"
            surfaces |= {f"{label}_{face}": own[face] for face in ("upper", "lower")}
            surfaces[f"{label}_tip"], foot = own["shroud"], own["hub"]
            orientations |= {f"{label}_upper": -1, f"{label}_lower": 1, f"{label}_tip": 1}
        surfaces[f"hub_{number}"], line = piece(hub, turn, pitch, foot)
        orientations[f"hub_{number}"] = 1
        edges.append(line)
    (front, top), (back, bottom) = hub(FRONT), hub(BACK)
    inner = 0.0 if solid else BORE
    outline = {
        "rim_front": ((front, 0.0, top), (front, 0.0, inner)),
        "bore": ((front, 0.0, inner), (back, 0.0, inner)),
        "rim_back": ((back, 0.0, inner), (back, 0.0, bottom)),
    }
    for face, ends in outline.items():
        if not (solid and face == "bore"):
            surfaces[face], orientations[face] = revolved(segment(*ends), axis=LEFT_HANDED, smooth=True), -1
    return Wheel(
        name=name,
        surfaces=surfaces,
        orientations=orientations,
        properties=mass_properties([(surfaces[face], sign) for face, sign in orientations.items()]),
        edges=tuple(edges),
    )
