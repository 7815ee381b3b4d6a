"""Flow passages about a round-nosed vane: patches whose walls carry the vane's own knots between extensions."""

import numpy as np

from bladewright.nurbs.curve import Curve
from bladewright.nurbs.domain import reparametrised, split
from bladewright.nurbs.mass_properties import mass_properties
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface

from .closed_forms import Blade

DEGREE = 5
SIDE = np.array([0.0] * 6 + [0.1, 0.2, 0.35, 0.5, 0.5, 0.65, 0.8, 0.9] + [1.0] * 6)
"""the vane's own knots"""
SPAN = np.array([0.0] * 6 + [0.4] + [1.0] * 6)
ACROSS = np.array([0.0] * 6 + [0.5] + [1.0] * 6)
EXTENSION = np.array([0.0] * 6 + [1.0] * 6)
BEFORE, AFTER = 0.3, 0.7
"""where on the walls the vane begins and ends"""
HEIGHT, PITCH, CLEARANCE = 0.05, 0.06, 0.1
ORIENTATIONS = {
    "hub_upper": -1, "hub_lower": 1, "shroud_upper": 1, "shroud_lower": -1,
    "periodic_upper": -1, "periodic_lower": 1, "inlet": -1, "outlet": 1, "blade_upper": 1, "blade_lower": -1,
}  # fmt: skip


def greville(knots: np.ndarray) -> np.ndarray:
    return np.array([knots[i + 1 : i + DEGREE + 1].mean() for i in range(len(knots) - DEGREE - 1)])


def joined(*pieces: tuple[np.ndarray, float, float]) -> np.ndarray:
    """Knots of pieces set one behind another over [start, end], full multiplicity between them."""
    whole = [0.0]
    for knots, start, end in pieces:
        whole += [start] * DEGREE + (start + (end - start) * knots[DEGREE + 1 : -DEGREE - 1]).tolist()
    return np.array([*whole, *[1.0] * (DEGREE + 1)])


ALONG = joined((EXTENSION, 0.0, BEFORE), (SIDE, BEFORE, AFTER), (EXTENSION, AFTER, 1.0))
HALVES = joined((ACROSS, 0.0, 0.5), (ACROSS, 0.5, 1.0))


def camber(x: np.ndarray) -> np.ndarray:
    return 0.3 * x - 2.0 * x * x


def line(xs: np.ndarray, rise: float) -> np.ndarray:
    return np.stack([xs, camber(xs) + rise], axis=-1)


def sides() -> tuple[np.ndarray, np.ndarray]:
    """Control points (n, 2) of the vane's upper and lower side, which leave the edges square to the camber."""
    u = greville(SIDE)
    x = 0.1 * np.concatenate([[0.0], u[:-2], [1.0]])
    x[1], x[-2] = x[0], x[-1]
    thickness = 0.012 * np.sin(np.pi * np.clip(u, 0.0, 1.0)) ** 0.6
    thickness[[0, -1]] = 0.0
    return line(x, 0.0) + np.outer(thickness, [0, 1]), line(x, 0.0) - np.outer(thickness, [0, 0.6])


def chained(*rows: np.ndarray) -> np.ndarray:
    return np.concatenate([rows[0], *[row[1:] for row in rows[1:]]])


def blended(first: np.ndarray, last: np.ndarray, knots: np.ndarray) -> np.ndarray:
    """Control points (n, m, ...) of lines from one row (n, ...) to another."""
    share = greville(knots)[None, :, None]
    return (1.0 - share) * first[:, None] + share * last[:, None]


def passage(*, name: str = "vane-passage", clearance: bool = False, bow: float = 0.02) -> Blade:
    """The passage of a vane of 0.1 m between hub and shroud, with a gap above its tip where there is a clearance."""
    extension = greville(EXTENSION)
    ahead, behind = line(-0.05 * (1.0 - extension), 0.0), line(0.1 + 0.04 * extension, 0.0)
    upper, lower = sides()
    # the boundary reaches further than the vane, so that its lines leave the nose between side and extension
    far = chained(-0.05 + 0.03 * extension, -0.02 + 0.135 * greville(SIDE), 0.115 + 0.025 * extension)
    rows = {
        "upper": chained(ahead, upper, behind), "lower": chained(ahead, lower, behind),
        "middle": chained(ahead, line(0.1 * greville(SIDE), 0.0), behind),
    }  # fmt: skip
    outer = {"upper": line(far, PITCH / 2.0), "lower": line(far, -PITCH / 2.0)}
    bow = 0.0 if clearance else bow
    tip = 1.0 - CLEARANCE if clearance else 1.0

    def placed(points: np.ndarray, s: np.ndarray | float) -> np.ndarray:
        """Points (..., 2) of the plane at shares s of the span, leant, turned and bowed."""
        x, y = np.moveaxis(points, -1, 0)
        s = np.broadcast_to(s, x.shape)
        return np.stack([x + 0.01 * s, y + 0.3 * s * x + 0.01 * s * s, HEIGHT * s + bow * (x + 4.0 * s * x * x)], -1)

    def wall(side: str, s: float, row: str) -> Surface:
        net = placed(blended(rows[row], outer[side], ACROSS), s)
        return Surface(control_points=net, knots_u=ALONG, knots_v=ACROSS, degree_u=DEGREE, degree_v=DEGREE)

    def upright(row: np.ndarray, knots: np.ndarray, top: float = 1.0) -> Surface:
        share = top * greville(SPAN)
        net = placed(np.repeat(row[:, None], len(share), axis=1), share[None, :])
        return Surface(control_points=net, knots_u=knots, knots_v=SPAN, degree_u=DEGREE, degree_v=DEGREE)

    def end(index: int) -> Surface:
        columns = {side: blended(rows[side], outer[side], ACROSS)[index] for side in ("upper", "lower")}
        return upright(chained(columns["lower"][::-1], columns["upper"]), HALVES)

    surfaces: dict[str, Surface | TrimmedSurface] = {
        "hub_upper": wall("upper", 0.0, "upper"),
        "hub_lower": wall("lower", 0.0, "lower"),
        "shroud_upper": wall("upper", 1.0, "middle" if clearance else "upper"),
        "shroud_lower": wall("lower", 1.0, "middle" if clearance else "lower"),
        "periodic_upper": upright(outer["upper"], ALONG),
        "periodic_lower": upright(outer["lower"], ALONG),
        "inlet": end(0),
        "outlet": end(-1),
        "blade_upper": upright(upper, SIDE, tip),
        "blade_lower": upright(lower, SIDE, tip),
    }
    orientations = dict(ORIENTATIONS)
    if clearance:
        surfaces["tip"] = _tip(surfaces["blade_upper"], surfaces["blade_lower"])
        orientations["tip"] = -1
    return _closed(name, surfaces, orientations)


def _closed(name: str, surfaces: dict[str, Surface | TrimmedSurface], orientations: dict[str, int]) -> Blade:
    enclosed = mass_properties([(surfaces[label], sign) for label, sign in orientations.items()])
    return Blade(name=name, surfaces=surfaces, orientations=orientations, properties=enclosed)


def _tip(upper: Surface, lower: Surface) -> TrimmedSurface:
    low, high = np.array([-0.02, -0.04]), np.array([0.15, 0.06])
    z = float(upper.control_points[0, -1, 2])
    corners = np.array([[[x, y, z] for y in (low[1], high[1])] for x in (low[0], high[0])])
    plane = Surface(control_points=corners, knots_u=[0, 0, 1, 1.0], knots_v=[0, 0, 1, 1.0], degree_u=1, degree_v=1)
    ahead, back = ((side.control_points[:, -1, :2] - low) / (high - low) for side in (lower, upper))
    boundary = (
        Curve(control_points=ahead, knots=SIDE, degree=DEGREE),
        Curve(control_points=back[::-1], knots=1.0 - SIDE[::-1], degree=DEGREE),
    )
    return TrimmedSurface(surface=plane, boundary=boundary, revolution=None)


def divided(built: Blade) -> Blade:
    """The same passage of faces without a crease: each is split at its knots of full multiplicity."""
    surfaces: dict[str, Surface | TrimmedSurface] = {}
    orientations = {}
    for name, face in built.surfaces.items():
        pieces = [face]
        if isinstance(face, Surface):
            inner, counts = np.unique(face.knots_u[DEGREE + 1 : -DEGREE - 1], return_counts=True)
            creases = inner[counts == DEGREE]
            pieces = [reparametrised(each) for each in split(face, creases)] if len(creases) else [face]
        labels = {1: [""], 2: ["_lower", "_upper"], 3: ["_inlet", "_blade", "_outlet"]}[len(pieces)]
        for label, piece in zip(labels, pieces, strict=True):
            surfaces[name + label], orientations[name + label] = piece, built.orientations[name]
    return _closed(f"{built.name}-divided", surfaces, orientations)
