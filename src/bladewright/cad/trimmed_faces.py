"""Trimmed faces for OpenCASCADE: exact planes and surfaces of revolution, with the parameter curves that trim them."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from OCP.Geom import Geom_Plane, Geom_Surface, Geom_SurfaceOfRevolution
from OCP.gp import gp_Ax1, gp_Ax3, gp_Dir, gp_Pnt
from scipy.interpolate import make_interp_spline

from bladewright.cad.conversion import space_curve, space_surface
from bladewright.cad.native_body import MM
from bladewright.cad.topology import BodyEdge, Coedge
from bladewright.errors import CadError
from bladewright.numerics.elementary import Array, unit
from bladewright.numerics.roots import level_crossings
from bladewright.nurbs.basis import greville, knots_with_joints
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.revolution import Revolution
from bladewright.nurbs.trimmed import TrimmedSurface

Along = Callable[[Array], Array]
"""a quantity along an edge, as a function of the edge's parameter"""

PCURVE_TOLERANCE = 1e-10
"""Largest interpolation error of a trimming curve, as a fraction of the edge's extent. It adds to the distance of the
edge from its wall, of which 1e-7 of the chord is allowed, and is far below it."""

SPAN_DIGITS = 6
"""Digits to which ends of an edge on the boundary of a face and of its turned copy agree: each is found by search."""


@dataclass(frozen=True, kw_only=True, eq=False)
class TrimmedFace:
    """A trimmed face as OpenCASCADE holds it."""

    geometry: Geom_Surface
    """[mm]"""
    pcurves: tuple[Curve, ...]
    """trimming curves in the parameters of `geometry`, one for each edge and with the parameter of that edge"""
    reversed_normal: bool
    """whether the normal of `geometry` is opposite to the native one"""


Known = dict[object, Curve]
"""Pcurves of faces of revolution, which their turned copies have too."""


def trimmed_face(face: TrimmedSurface, edges: list[tuple[BodyEdge, Coedge]], known: Known) -> TrimmedFace:
    """The surface of a trimmed face, and the pcurves of its edges, which are given in the order of its curves.

    Those of a face of revolution are added to the `known` ones, or taken from there.
    """
    if face.revolution is not None:
        return _revolved(face, face.revolution, edges, known)
    net = face.surface.control_points
    corner, along, across = net[0, 0], net[-1, 0] - net[0, 0], net[0, -1] - net[0, 0]
    normal = unit(np.cross(along, across))
    if np.max(np.abs((net - corner) @ normal)) <= 1e-14 * np.max(np.abs(net - corner)):
        return _plane(corner, unit(along), normal, edges)
    return _patch(face, edges)


def _plane(corner: Array, along: Array, normal: Array, edges: list[tuple[BodyEdge, Coedge]]) -> TrimmedFace:
    axes = np.stack([along, np.cross(normal, along)])
    frame = gp_Ax3(gp_Pnt(*(corner * MM).tolist()), gp_Dir(*normal.tolist()), gp_Dir(*along.tolist()))
    pcurves = tuple(
        Curve(
            control_points=(edge.curve.control_points - corner) @ axes.T * MM,
            knots=edge.curve.knots,
            degree=edge.curve.degree,
            weights=edge.curve.weights,
        )
        for edge, _ in edges
    )
    return TrimmedFace(geometry=Geom_Plane(frame), pcurves=pcurves, reversed_normal=False)


def _revolved(
    face: TrimmedSurface, revolution: Revolution, edges: list[tuple[BodyEdge, Coedge]], known: Known
) -> TrimmedFace:
    """A surface of revolution about -x, about which theta is right-handed.

    OpenCASCADE's angle starts half a turn before the middle of the face, so that no pcurve comes near the seam.
    """
    line = revolution.meridian
    angles = [np.asarray(revolution.theta(boundary(_spread(boundary.knots, 201))[:, 1])) for boundary in face.curves]
    low, high = min(float(a.min()) for a in angles), max(float(a.max()) for a in angles)
    if high - low >= 2.0 * np.pi:
        raise CadError(
            f"an end face winds {np.degrees(high - low):.0f} deg around the axis: the kernel trims a surface of "
            "revolution within one turn; close the blade with extended ends instead"
        )
    start = 0.5 * (low + high) - np.pi
    x, r = (line.control_points * MM).T
    meridian = Curve(
        control_points=np.stack([x, r * np.sin(start), r * np.cos(start)], axis=-1) / MM,
        knots=line.knots,
        degree=line.degree,
        weights=line.weights,
    )
    axis = gp_Ax1(gp_Pnt(0.0, 0.0, 0.0), gp_Dir(-1.0, 0.0, 0.0))

    def pcurve(edge: BodyEdge, coedge: Coedge) -> Curve:
        boundary = face.curves[coedge.side]
        s = np.linspace(*coedge.span, 201)
        guides = boundary(s if coedge.along else s[::-1])
        reference = np.asarray(revolution.theta(guides[:, 1]))

        def place(w: Array) -> Array:
            points = edge.curve(w)
            share = (w - edge.curve.knots[0]) / (edge.curve.knots[-1] - edge.curve.knots[0])
            ahead = np.interp(share, np.linspace(0.0, 1.0, len(reference)), reference)
            theta = np.arctan2(points[:, 1], points[:, 2])
            theta = theta + 2.0 * np.pi * np.round((ahead - theta) / (2.0 * np.pi))
            meridional = np.stack([points[:, 0], np.sqrt(points[:, 1] ** 2 + points[:, 2] ** 2)], axis=-1)
            return np.stack([theta - start, _foot(line, meridional)], axis=-1)

        def scales(uv: Array) -> Array:
            tangent = line.derivative(uv[:, 1])
            return np.stack([line(uv[:, 1])[:, 1], np.sqrt(np.sum(tangent * tangent, axis=-1))], axis=-1)

        return _interpolated(place, scales, edge.curve, _joints(place, 1, line.knots, line.degree, edge.curve))

    def known_pcurve(edge: BodyEdge, coedge: Coedge) -> Curve:
        # the span tells which turn the angles belong to, and is found anew for every copy
        span, knots = np.round(coedge.span, SPAN_DIGITS).tobytes(), edge.curve.knots.tobytes()
        same = line, face.curves, coedge.side, coedge.along, span, knots
        if same not in known:
            known[same] = pcurve(edge, coedge)
        return known[same]

    return TrimmedFace(
        geometry=Geom_SurfaceOfRevolution(space_curve(meridian), axis),
        pcurves=tuple(known_pcurve(edge, coedge) for edge, coedge in edges),
        reversed_normal=True,
    )


def _patch(face: TrimmedSurface, edges: list[tuple[BodyEdge, Coedge]]) -> TrimmedFace:
    """Any other trimmed face: on its own B-spline surface, the edges projected to it."""
    surface = face.surface

    def pcurve(edge: BodyEdge, coedge: Coedge) -> Curve:
        boundary = face.curves[coedge.side]
        guides = boundary(np.linspace(*coedge.span, 2001))
        ahead = surface(*guides.T)

        def place(w: Array) -> Array:
            points = edge.curve(w)
            near = np.argmin(np.sum((points[:, None] - ahead[None]) ** 2, axis=-1), axis=1)
            uv = guides[near]
            for _ in range(20):
                u, v = uv.T
                du, dv = surface.derivative(u, v, 1, 0), surface.derivative(u, v, 0, 1)
                miss = points - surface(u, v)
                a, b, c = (np.sum(p * q, axis=-1) for p, q in ((du, du), (du, dv), (dv, dv)))
                e, f = np.sum(du * miss, axis=-1), np.sum(dv * miss, axis=-1)
                uv = uv + np.stack([c * e - b * f, a * f - b * e], axis=-1) / (a * c - b * b)[:, None]
            return uv

        def scales(uv: Array) -> Array:
            u, v = uv.T
            tangents = (surface.derivative(u, v, 1, 0), surface.derivative(u, v, 0, 1))
            return np.stack([np.sqrt(np.sum(t * t, axis=-1)) for t in tangents], axis=-1)

        joints = _joints(place, 0, surface.knots_u, surface.degree_u, edge.curve)
        return _interpolated(place, scales, edge.curve, joints)

    pcurves = tuple(pcurve(edge, coedge) for edge, coedge in edges)
    return TrimmedFace(geometry=space_surface(surface), pcurves=pcurves, reversed_normal=False)


def _spread(knots: Array, count: int) -> Array:
    return np.linspace(knots[0], knots[-1], count)


def _foot(line: Curve, points: Array) -> Array:
    """Parameters (n,) of the points of a meridian curve that are nearest to points (n, 2)."""
    spread = _spread(line.knots, 201)
    away = (points[:, :1] - line(spread)[:, 0]) ** 2 + (points[:, 1:] - line(spread)[:, 1]) ** 2
    t = spread[np.argmin(away, axis=1)]
    for _ in range(12):
        miss, first, second = line(t) - points, line.derivative(t), line.derivative(t, 2)
        slope = np.einsum("ij,ij->i", first, first) + np.einsum("ij,ij->i", miss, second)
        step = np.einsum("ij,ij->i", miss, first) / slope
        t = np.clip(t - step, line.knots[0], line.knots[-1])
        # Newton's method converges quadratically: the next step would be the square of this one
        if np.max(np.abs(step)) <= 1e-9 * (line.knots[-1] - line.knots[0]):
            break
    return t


def _joints(place: Along, column: int, knots: Array, degree: int, along: Curve) -> list[tuple[float, int]]:
    """Parameters at which an edge crosses inner knots of its wall, and the order of continuity of its pcurve there."""
    levels, counts = (found[1:-1] for found in np.unique(knots, return_counts=True))
    if len(levels) == 0:
        return []
    w = _spread(along.knots, 401)
    values = place(w)[:, column]
    return [
        (float(at), degree - int(times))
        for times in np.unique(counts)
        for at in level_crossings(lambda s: place(s)[:, column], w, values, levels[counts == times])
    ]


def _interpolated(place: Along, scales: Along, along: Curve, joints: list[tuple[float, int]]) -> Curve:
    """A plane B-spline of at least degree 5 through `place(w)`, with the knots of the edge, halved until it is close.

    `scales` gives the metres per unit of the two parameters, `joints` where the pcurve is less smooth than the edge.
    """
    degree = max(5, along.degree)
    inner, counts = np.unique(along.knots[along.degree + 1 : -along.degree - 1], return_counts=True)
    counts = np.minimum(counts + degree - along.degree, degree)
    ends = np.repeat(along.knots[[0, -1]], degree + 1)
    whole = knots_with_joints(np.sort(np.concatenate([ends, np.repeat(inner, counts)])), degree, joints)
    inner, counts = np.unique(whole[degree + 1 : -degree - 1], return_counts=True)
    size = float(np.ptp(along.control_points, axis=0).max())
    for division in (1, 2, 4, 8, 16, 32):
        ends = np.concatenate([along.knots[:1], inner, along.knots[-1:]])
        added = (ends[:-1, None] + np.diff(ends)[:, None] * np.arange(1, division) / division).ravel()
        knots = np.sort(np.concatenate([np.repeat(ends[0], degree + 1), np.repeat(inner, counts), added,
                                        np.repeat(ends[-1], degree + 1)]))  # fmt: skip
        sites = greville(knots, degree)
        spline = make_interp_spline(sites, place(sites), k=degree, t=knots)
        between = 0.5 * (sites[1:] + sites[:-1])
        exact = place(between)
        miss = np.max(np.abs(spline(between) - exact) * scales(exact))
        if miss <= PCURVE_TOLERANCE * size:
            return Curve(control_points=spline.c, knots=knots, degree=degree)
    raise CadError(
        f"a trimming curve misses its edge by {miss:.3g} m with {len(sites)} control points, at most "
        f"{PCURVE_TOLERANCE * size:.3g} m are allowed: the edge is not smooth enough on its wall; "
        "refine the surface there"
    )
