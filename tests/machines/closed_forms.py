"""Blades of closed formulas to try the CAD room with: smooth, twisted, between curved walls of revolution or planes."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.interpolate import make_interp_spline

from bladewright.nurbs.basis import greville, uniform_knots
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.revolution import Revolution
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface

UNIFORM = uniform_knots(6, 3)
HUB = np.array([[-0.05, 0.200], [0.0, 0.203], [0.05, 0.212], [0.1, 0.216], [0.15, 0.214]])
SHROUD = np.array([[-0.05, 0.310], [0.0, 0.309], [0.05, 0.304], [0.1, 0.300], [0.15, 0.301]])


@dataclass(frozen=True, kw_only=True)
class Properties:
    volume: float
    area: float
    areas: np.ndarray
    centroid: np.ndarray


@dataclass(frozen=True, kw_only=True)
class Promises:
    error: float = 1e-9

    def to_dict(self) -> dict[str, float]:
        return {"surface_error_m": self.error}


@dataclass(frozen=True, kw_only=True)
class Blade:
    name: str
    surfaces: Mapping[str, Surface | TrimmedSurface]
    orientations: Mapping[str, int]
    properties: Properties
    description: str = "a blade of closed formulas"
    author: str = "A. Author"
    organisation: str = "Institute of Blades"
    conformance: Promises = field(default_factory=Promises)


def blade(name: str, surfaces: Mapping, orientations: Mapping[str, int]) -> Blade:
    return Blade(name=name, surfaces=surfaces, orientations=orientations, properties=properties(surfaces, orientations))


def replaced(built: Blade, **faces: Surface | TrimmedSurface) -> Blade:
    """The blade with some of its faces replaced, though it still says that its volume is the old one's."""
    return replace(built, surfaces={**built.surfaces, **faces})


def moved(face: Surface, row: int, column: int, by: float) -> Surface:
    """A surface of which one control point is moved along y [m], across the sides of the blades."""
    net = np.array(face.control_points)
    net[row, column, 1] += by
    return replace(face, control_points=net)


def doubled(count: int, degree: int, at: tuple[float, ...] = (0.5,), multiplicity: int = 3) -> np.ndarray:
    """Clamped knots, uniform but for knots of a higher multiplicity."""
    inner = np.linspace(0.0, 1.0, count + 1)[1:-1]
    repeated = np.concatenate([inner[[np.argmin(np.abs(inner - place)) for place in at]]] * (multiplicity - 1))
    return np.concatenate([np.zeros(degree + 1), np.sort(np.concatenate([inner, repeated])), np.ones(degree + 1)])


def section(u: np.ndarray, v: np.ndarray, side: int) -> tuple[np.ndarray, np.ndarray]:
    """Place along the meridian t and angle theta of a rounded, cambered, twisted section."""
    phi = np.pi * u
    along = 0.5 - 0.5 * np.cos(phi)
    t = 0.30 + (0.36 + 0.04 * v) * along + 0.01 * v * v
    camber = (0.25 + 0.10 * v) * along + 0.05 * along * along - 0.15
    thickness = (0.028 - 0.010 * v) * (1.0 - 0.35 * along)
    return t, camber + side * thickness * np.sin(phi)


def meridian(points: np.ndarray) -> Curve:
    return Curve(control_points=points, knots=np.array([0, 0, 0, 0, 0.5, 1, 1, 1, 1.0]), degree=3)


def fitted(function: Callable, knots: np.ndarray, degree: int = 5) -> Curve:
    sites = greville(knots, degree)
    spline = make_interp_spline(sites, function(sites), k=degree, t=knots)
    return Curve(control_points=spline.c, knots=knots, degree=degree)


def side(place: Callable, sign: int, knots_u: np.ndarray, knots_v: np.ndarray) -> Surface:
    u, v = greville(knots_u, 5), greville(knots_v, 5)
    values = place(u[:, None], v[None, :], sign)
    along_u = make_interp_spline(u, values, k=5, t=knots_u).c
    net = make_interp_spline(v, along_u, k=5, t=knots_v, axis=1).c
    # make_interp_spline puts the interpolated axis first
    net = net if net.shape[:2] == (len(u), len(v)) else np.swapaxes(net, 0, 1)
    return Surface(control_points=net, knots_u=knots_u, knots_v=knots_v, degree_u=5, degree_v=5)


def shared(upper: Surface, lower: Surface) -> Surface:
    """The lower side with the upper side's edge rows."""
    net = np.array(lower.control_points)
    net[0], net[-1] = upper.control_points[0], upper.control_points[-1]
    return Surface(control_points=net, knots_u=lower.knots_u, knots_v=lower.knots_v, degree_u=5, degree_v=5)


def annular(*, name: str = "rotor", spans: int = 16, turn: float = 0.0) -> Blade:
    """A blade of about 0.1 m between curved walls of revolution; `turn` rotates it about the machine axis."""
    hub, shroud = meridian(HUB), meridian(SHROUD)

    def place(u: np.ndarray, v: np.ndarray, sign: int) -> np.ndarray:
        t, theta = np.broadcast_arrays(*section(u, v, sign))
        line = (1.0 - v)[..., None] * hub(t) + v[..., None] * shroud(t)
        x, r = line[..., 0], line[..., 1]
        return np.stack([x, r * np.sin(theta + turn), r * np.cos(theta + turn)], axis=-1)

    knots_u, knots_v = doubled(spans, 5), doubled(12, 5, at=(0.25, 0.5))
    upper = side(place, 1, knots_u, knots_v)
    lower = shared(upper, side(place, -1, knots_u, knots_v))
    surfaces: dict[str, Surface | TrimmedSurface] = {"upper": upper, "lower": lower}
    for label, line, v in (("hub", hub, 0.0), ("shroud", shroud, 1.0)):
        revolution = Revolution(meridian=line, start=turn - 0.4, end=turn + 0.5)

        def trace(u: np.ndarray, sign: int, v: float = v, revolution: Revolution = revolution) -> np.ndarray:
            t, theta = section(u, np.full_like(u, v), sign)
            return np.stack([t, revolution.v(theta + turn)], axis=-1)

        fine = doubled(2 * spans, 5)
        # theta grows with v, so lower side out, upper side back runs counter-clockwise in (u, v)
        boundary = (
            fitted(lambda u, trace=trace: trace(u, -1), fine),
            fitted(lambda u, trace=trace: trace(1.0 - u, 1), fine),
        )
        surfaces[label] = TrimmedSurface(surface=revolution.surface(), boundary=boundary, revolution=revolution)
    # e_x x e_r = -e_theta on the sides, of which the upper lies at the larger theta; e_x x e_theta = e_r on the walls
    orientations = {"upper": -1, "lower": 1, "hub": -1, "shroud": 1}
    return blade(name, surfaces, orientations)


def linear(*, name: str = "vane", spans: int = 36) -> Blade:
    """A prismatic blade of a linear cascade between the planes z = 0 and z = 0.12."""
    height = 0.12

    def place(u: np.ndarray, v: np.ndarray, sign: int) -> np.ndarray:
        t, y = np.broadcast_arrays(*section(u, 0.0 * v, sign))
        return np.stack([0.25 * t, 0.2 * y, height * np.broadcast_to(v, t.shape)], axis=-1)

    knots_u, knots_v = doubled(spans, 5), np.array([0.0] * 6 + [1.0] * 6)
    upper = side(place, 1, knots_u, knots_v)
    lower = shared(upper, side(place, -1, knots_u, knots_v))
    surfaces: dict[str, Surface | TrimmedSurface] = {"upper": upper, "lower": lower}
    low, high = np.array([-0.1, -0.2]), np.array([0.4, 0.2])
    for label, z in (("hub", 0.0), ("shroud", height)):
        corners = np.array([[[x, y, z] for y in (low[1], high[1])] for x in (low[0], high[0])])
        plane = Surface(control_points=corners, knots_u=[0, 0, 1, 1.0], knots_v=[0, 0, 1, 1.0], degree_u=1, degree_v=1)
        edge = 0 if label == "hub" else -1
        chain = []
        for body, backwards in ((lower, False), (upper, True)):
            points = (body.control_points[:, edge, :2] - low) / (high - low)
            chain.append(
                Curve(
                    control_points=points[::-1] if backwards else points,
                    knots=1.0 - knots_u[::-1] if backwards else knots_u,
                    degree=5,
                )
            )
        surfaces[label] = TrimmedSurface(surface=plane, boundary=tuple(chain), revolution=None)
    orientations = {"upper": -1, "lower": 1, "hub": -1, "shroud": 1}
    return blade(name, surfaces, orientations)


def ruled_ends(*, name: str = "extended") -> Blade:
    """The annular blade closed by ruled surfaces, which collapse at both edges, instead of walls."""
    walls = annular()
    upper, lower = walls.surfaces["upper"], walls.surfaces["lower"]
    surfaces: dict[str, Surface | TrimmedSurface] = {"upper": upper, "lower": lower}
    for label, edge in (("hub", 0), ("shroud", -1)):
        net = np.stack([lower.control_points[:, edge], upper.control_points[:, edge]], axis=1)
        surfaces[label] = Surface(
            control_points=net, knots_u=lower.knots_u, knots_v=[0, 0, 1, 1.0], degree_u=5, degree_v=1
        )
    orientations = {"upper": -1, "lower": 1, "hub": -1, "shroud": 1}
    return blade(name, surfaces, orientations)


def brick(*, name: str = "passage") -> Blade:
    """A curved six-sided body of patches of which each shares its boundary control points with its neighbours."""
    u = greville(UNIFORM, 3)
    x, y, z = np.meshgrid(u, u, u, indexing="ij")
    net = np.stack([0.1 * x + 0.01 * y * z, 0.08 * y + 0.02 * np.sin(3 * x), 0.05 * z + 0.01 * x * y], axis=-1)
    slices = {
        "inlet": net[0], "outlet": net[-1], "pressure": net[:, 0], "suction": net[:, -1],
        "hub": net[:, :, 0], "shroud": net[:, :, -1],
    }  # fmt: skip
    # one patch runs the other way round, as patches of different origin do
    slices["outlet"] = slices["outlet"][::-1]
    surfaces = {
        label: Surface(control_points=points, knots_u=UNIFORM, knots_v=UNIFORM, degree_u=3, degree_v=3)
        for label, points in slices.items()
    }
    orientations = {"inlet": -1, "outlet": -1, "pressure": 1, "suction": -1, "hub": -1, "shroud": 1}
    return blade(name, surfaces, orientations)


def gauss(knots: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    sites, weights = np.polynomial.legendre.leggauss(count)
    spans = np.unique(knots)
    half = 0.5 * np.diff(spans)
    return (
        (spans[:-1, None] + half[:, None] * (sites + 1.0)).ravel(),
        (half[:, None] * weights).ravel(),
    )


def strip(face: TrimmedSurface) -> tuple[np.ndarray, np.ndarray]:
    """Parameters (n, 2) and weights (n,) that integrate over the region between the two boundary curves."""
    lower, upper = face.boundary
    s, ws = gauss(lower.knots, 8)
    q, wq = gauss(np.array([0.0, 1.0]), 8)
    weight = np.outer(ws, wq).ravel()
    s, q = np.repeat(s, len(q)), np.tile(q, len(s))
    start, end = lower(s), upper(1.0 - s)
    along = (1.0 - q)[:, None] * lower.derivative(s) - q[:, None] * upper.derivative(1.0 - s)
    across = end - start
    jacobian = along[:, 0] * across[:, 1] - along[:, 1] * across[:, 0]
    return start + q[:, None] * across, weight * jacobian


def elements(face: Surface | TrimmedSurface) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 3) and area vectors (n, 3) of dS/du x dS/dv."""
    if isinstance(face, Surface):
        u, wu = gauss(face.knots_u, 16)
        v, wv = gauss(face.knots_v, 8)
        normals = np.cross(face.grid(u, v, 1, 0), face.grid(u, v, 0, 1)) * np.outer(wu, wv)[..., None]
        return face.grid(u, v).reshape(-1, 3), normals.reshape(-1, 3)
    uv, weights = strip(face)
    u, v = uv.T
    surface = face.surface
    normals = np.cross(surface.derivative(u, v, 1, 0), surface.derivative(u, v, 0, 1)) * weights[:, None]
    return surface(u, v), normals


def properties(surfaces: Mapping, orientations: Mapping[str, int]) -> Properties:
    volume, areas, moment = 0.0, [], np.zeros(3)
    for label in orientations:
        points, vectors = elements(surfaces[label])
        vectors = vectors * orientations[label]
        volume += np.sum(points * vectors) / 3.0
        areas.append(np.sum(np.sqrt(np.sum(vectors * vectors, axis=-1))))
        moment += 0.5 * np.sum(points * points * vectors, axis=0)
    return Properties(volume=float(volume), area=float(np.sum(areas)), areas=np.array(areas), centroid=moment / volume)


BODIES = {"annular": annular, "linear": linear, "ruled ends": ruled_ends, "brick": brick}
