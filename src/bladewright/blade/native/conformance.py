"""What the built surfaces keep of what the design asks for, measured on them and not on what they were made from."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

import numpy as np

from bladewright.blade.exact.section_stack import SectionStack
from bladewright.blade.flow_path.meridional_curve import real_first
from bladewright.blade.native.moving_points import directions
from bladewright.blade.native.refinement import sections_limit
from bladewright.numerics.elementary import Array, cross, cross2, degrees, dot, length, unit
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.surface import Surface

if TYPE_CHECKING:
    from bladewright.blade.native.blade import Blade


ENDS = np.array([0.0, 1.0])
SHARES = np.array([0.0, 0.25, 0.5, 0.75])
"""places in each knot span along a side"""


LIMITS = {
    "metal_angle_at_walls": 1e-6,
    "metal_angle_between": 1e-2,
    "edge_radius": 1e-3,
    "edge_tangent_planes": 1e-9,
    "edge_curvatures": 1e-6,
    "walls": 1e-7,
}
FLAT = 100.0
"""Radius [chords] from which on an edge counts as flat, as the back face of a wedge diffuser's vane is: its radius
is not compared."""
CLEARANCE = 1e-8
"""Largest error of the clearance [chords], as `docs/nomenclature.md` promises."""
DEVELOPED = 1e-6
"""Largest twist of developable sides [deg]: rounding, with a margin."""


@dataclass(frozen=True, kw_only=True)
class Twist:
    """The largest turn of a side's normal along one of its straight lines, from v = 0 to v = 1."""

    angle: float
    """[rad]"""
    u: float
    side: str
    """`upper` or `lower`"""

    @property
    def cut(self) -> float:
        """Depth to which a cylinder along that line cuts into the side at its ends, of the cylinder's radius [-].

        R (1 - cos(angle / 2)): the cylinder touches the line with its normal amid those of its ends, and beside the
        line the side is taken for flat. Where the angle is nothing all along a side, it is developable.
        """
        return float(1.0 - np.cos(self.angle / 2.0))


def twist_of(sides: tuple[Surface, Surface]) -> Twist:
    """The largest twist of sides whose lines of constant u are straight."""
    found = []
    for name, side in zip(("upper", "lower"), sides, strict=True):
        u = _places(side.knots_u)
        normals = side.normal(u[:, None], ENDS)
        # by both sine and cosine: either alone is inexact near 0 or a quarter turn
        sine, cosine = length(cross(normals[:, 0], normals[:, 1])), dot(normals[:, 0], normals[:, 1])
        angles = np.arctan2(sine, cosine)  # real: measured on the real surfaces
        worst = int(np.argmax(angles))
        found.append(Twist(angle=float(angles[worst]), u=float(u[worst]), side=name))
    return max(found, key=lambda each: each.angle)


def _places(knots: Reals) -> Reals:
    spans = np.unique(knots)
    return np.append((spans[:-1, None] + np.diff(spans)[:, None] * SHARES).ravel(), spans[-1])


@dataclass(frozen=True, kw_only=True)
class Conformance:
    """Largest misses of the built blade; each has its limit in `LIMITS`."""

    metal_angle_at_walls: float | None
    """of the camber's angle at both edges from the metal angle, at hub and shroud; none for sections of families, whose
    camber need not be normal to the rounded edge [deg]"""
    metal_angle_between: float | None
    """the same at every span between [deg]"""
    edge_radius: float | None
    """of the radius of round edges in the stream surface from the design's, or from the exact section's,
    relative; none where no edge is round [-]"""
    edge_tangent_planes: float | None
    """angle between the sides' tangent planes across round edges [rad]"""
    edge_curvatures: float | None
    """jump of the normal curvatures across round edges, of the largest of them and not less than 1 / chord [-]"""
    stream_surfaces: float | None
    """distance of curves of constant v from their stream surfaces, of the chord; none of ruled blades, whose curves lie
    on none [-]"""
    walls: float
    """distance of the blade's ends from hub and shroud, or from the clearance surface, of the chord [-]"""
    surface: float
    """distance of the sides from the exact blade, of the chord [-]"""
    limits: dict[str, float]
    """what each may be"""
    clearance: float | None = None
    """of the tip surface's distance from its wall from the stated one, of the chord, where there is a clearance [-]"""
    sections: float | None = None
    """distance of the sides' curves of constant v from the sections that a design gives, at equal parameters, of the
    chord; limited where 200 poles along the sections suffice [-]"""
    twist: float | None = None
    """turn of the sides' normal along their straight lines, of ruled and developable blades [deg]"""
    twist_at: float | None = None
    """u where it is largest [-]"""
    flank_cut: float | None = None
    """depth to which the flank of a cylindrical cutter on that line cuts into the side, of the cutter's radius [-]"""

    @property
    def kept(self) -> bool:
        """Whether every figure is within its limit."""
        return all(getattr(self, name) <= limit for name, limit in self.limits.items())

    def to_dict(self) -> dict[str, object]:
        """All figures, their limits and whether they are kept, for JSON."""
        return {**asdict(self), "kept": self.kept}


def conformance_of(blade: "Blade") -> Conformance:
    """The conformance of a blade, measured at hub and shroud and at three places in each of the surface's knot spans.

    The mapping of the paper keeps neither angles nor radii: its limits are those of the edges and the walls only.
    """
    upper, lower = blade.sides
    spans = np.unique(upper.knots_v)
    inner = np.sort(np.concatenate([spans[:-1] + share * np.diff(spans) for share in (0.21, 0.53, 0.83)]))
    v = np.concatenate([[0.0], inner, [1.0]])
    sections = blade.exact.sections(v)
    angles, radii, planes, bends = [], [], [], []
    for end, own in zip((0, 1), sections.lower_edges(), strict=True):
        if own is not None:
            continue
        row = _edge(upper, lower, float(end), v)
        turn, radius = _angle_and_radius(sections, row[0], end)
        metal_angle, expected_radius = sections.metal_angle(end), sections.edge_radius(end)
        if metal_angle is not None:
            angles.append(np.abs(degrees(turn - np.real(metal_angle))))  # real: a measured angle
        if expected_radius is None:
            exact = sections.trailing_edge() if end else sections.leading_edge()
            expected_radius = _angle_and_radius(sections, dict(zip(_ALONG, map(_real_row, exact), strict=True)), end)[1]
        expected_radius = np.real(expected_radius)
        if np.max(expected_radius) < FLAT * blade.chord:
            radii.append(np.abs(radius / expected_radius - 1.0))  # real: a measured radius
        plane, bend = _smoothness(row, 1.0 / blade.chord)
        planes.append(plane)
        bends.append(bend)
    walls = [np.max(angle[[0, -1]]) for angle in angles]
    distance, ends = _off_stream_surfaces(sections, upper, lower)
    tolerance = blade.design.tolerance
    figures = {
        "metal_angle_at_walls": _largest(walls),
        "metal_angle_between": _largest(angles),
        "edge_radius": _largest(radii),
        "edge_tangent_planes": _largest(planes),
        "edge_curvatures": _largest(bends),
    }
    not_kept = {"metal_angle_at_walls", "metal_angle_between", "edge_radius"}
    not_kept = set() if sections.mapping.keeps_angles else not_kept
    ruled = sections.skinning == "ruled"
    limits = {**LIMITS, "surface": tolerance} | ({} if ruled else {"stream_surfaces": tolerance})
    limits = {
        name: limit for name, limit in limits.items() if name not in not_kept and figures.get(name, 0.0) is not None
    }
    clearance = _off_clearance(blade)
    if clearance is not None:
        limits["clearance"] = CLEARANCE
    if blade.knots.sections is not None:
        limits["sections"] = sections_limit(tolerance)
    twisted: dict[str, float] = {}
    if sections.skinning != "sections":
        twist = twist_of(blade.sides)
        twisted = {"twist": float(np.degrees(twist.angle)), "twist_at": twist.u, "flank_cut": twist.cut}
        limits |= {"twist": DEVELOPED} if sections.skinning == "developable" else {}
    return Conformance(
        **figures,
        **twisted,
        stream_surfaces=None if ruled else distance / blade.chord,
        walls=max(ends / blade.chord, blade.wall_error),
        surface=blade.error,
        limits=limits,
        clearance=clearance,
        sections=_off_sections(blade),
    )


_ALONG = ((0, 0), (1, 0), (2, 0))


def _real_row(values: Array) -> Reals:
    return real_first(values, 2)


def _largest(values: Sequence[Array]) -> float | None:
    return float(np.max(values)) if values else None


def _edge(upper: Surface, lower: Surface, end: float, v: Reals) -> list[dict[tuple[int, int], Array]]:
    orders = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
    at = np.array([end])
    return [{order: np.real(side.grid(at, v, *order))[0] for order in orders} for side in (upper, lower)]


def _angle_and_radius(sections: SectionStack, row: dict[tuple[int, int], Array], end: int) -> tuple[Reals, Reals]:
    """Camber angle [rad] and radius in the stream surface [m] of the upper side at an edge, (m,) each."""
    first, second, point = row[1, 0], row[2, 0], row[0, 0]
    slope = unit(np.real(sections.lines.position(np.array([float(end)]), 1))[..., 0, :])
    slope = slope.reshape(-1, *slope.shape[-2:])[0]
    meridional, tangential = directions(point, slope, revolved=sections.mapping.revolved)
    along, across = dot(first, meridional), dot(first, tangential)
    turn = np.arctan2(along, -across) if end else np.arctan2(-along, across)  # real: measured on the real surfaces
    plane_first = np.stack([along, across], axis=-1)
    plane_second = np.stack([dot(second, meridional), dot(second, tangential)], axis=-1)
    curvature = cross2(plane_first, plane_second) / length(plane_first) ** 3
    with np.errstate(divide="ignore"):
        return turn, 1.0 / np.abs(curvature)  # real: a measured radius, without end where the edge is flat


def _smoothness(row: list[dict[tuple[int, int], Array]], least: float) -> tuple[Reals, Reals]:
    """Angle between the tangent planes [rad] and jump of the normal curvatures across an edge, (m,) each.

    The jump is relative to the largest of the curvatures, or to the `least` [1/m] where the edge is flat.
    """
    normals = [unit(np.cross(side[1, 0], side[0, 1])) for side in row]
    plane = length(np.cross(normals[0], normals[1]))
    forms = []
    for side, normal, sign in zip(row, normals, (1.0, -1.0), strict=True):
        sizes = length(side[1, 0]), length(side[0, 1])
        terms = [dot(side[2, 0], normal) / sizes[0] ** 2, dot(side[1, 1], normal) * sign / (sizes[0] * sizes[1])]
        forms.append(np.stack([*terms, dot(side[0, 2], normal) / sizes[1] ** 2], axis=-1) * sign)
    jump = np.max(np.abs(forms[0] - forms[1]), axis=-1)  # real: measured curvatures
    return plane, jump / np.maximum(np.max(np.abs(forms[0]), axis=-1), least)  # real: measured curvatures


def _off_sections(blade: "Blade") -> float | None:
    """Largest distance of the sides from the exact sections at the spans that a design gives, of the chord."""
    spans = blade.exact.given_spans
    if len(spans) == 0:
        return None
    knots = np.unique(blade.sides[0].knots_u)
    u = np.sort(np.concatenate([knots[:-1] + share * np.diff(knots) for share in (0.21, 0.5, 0.83)]))
    sides = zip(blade.sides, blade.exact.sections(spans).points(u), strict=True)
    misses = [np.real(side.grid(u, spans).swapaxes(0, 1) - points) for side, points in sides]
    return float(np.max(length(np.stack([miss.reshape(-1, *miss.shape[-2:]) for miss in misses])))) / blade.chord


def _off_clearance(blade: "Blade") -> float | None:
    """Largest miss of the tip surface's distance from its wall between the edges, of the chord."""
    if "tip" not in blade.design.ends:
        return None
    exact = blade.exact
    u = np.linspace(*exact.clearance_range, 401)
    x, y, z = np.moveaxis(np.real(blade.surfaces["tip"](u, np.full_like(u, 0.5))), -1, 0)
    points = np.stack([x, length(np.stack([y, z], axis=-1)) if exact.mapping.revolved else z], axis=-1)
    errors = exact.clearance_error(u, points)
    return None if errors is None else float(np.max(errors)) / blade.chord


def _off_stream_surfaces(sections: SectionStack, upper: Surface, lower: Surface) -> tuple[float, float]:
    """Largest distances [m] of curves of constant v, and of the ends among them, from their stream surfaces."""
    spans = np.unique(upper.knots_u)
    u = np.sort(np.concatenate([spans, (spans[1:] + spans[:-1]) / 2.0]))
    offsets = [
        dot(np.real(side.grid(u, sections.v).swapaxes(0, 1) - points), np.real(normals))
        for side, points, normals in zip((upper, lower), *sections.points_and_normals(u), strict=True)
    ]
    distances = np.max(np.abs(offsets), axis=(0, -1)).reshape(-1, len(sections.v))[0]  # real: measured distances
    return float(np.max(distances)), float(np.max(distances[[0, -1]]))
