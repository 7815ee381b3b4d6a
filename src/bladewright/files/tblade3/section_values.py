"""Each section's parameters in a T-Blade3 case: splines along the span evaluated, angles on the stream surfaces."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from bladewright.errors import FileError
from bladewright.files.tblade3.case import LeadingEdges, Meanlines, Multipliers, SpanLaw, Table, TBlade3Case
from bladewright.nurbs.basis import Reals

BISECTIONS = 80
"""Bisections for the parameter of a spline at a span: more than the 53 bits of a double."""
_BASIS = np.array([[1.0, 4.0, 1.0, 0.0], [-3.0, 0.0, 3.0, 0.0], [3.0, -6.0, 3.0, 0.0], [-1.0, 3.0, -3.0, 1.0]]) / 6.0
"""Coefficients of a segment of a uniform cubic B-spline: power of t by control point."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SpanSpline:
    """The uniform cubic B-spline of points (span, values), as a function of the span.

    Its control points are `span` (n,), increasing, and `values` (n,) or (n, k). At both ends it has one more point
    P0 = 2 P1 - P2, so that the curve passes through the first and the last point without second derivative; there are
    n - 1 segments. A value is evaluated at the parameter t at which span(t) is the span that is asked for (Nemnem et
    al. 2014, eq. 6).
    """

    span: Reals
    values: Reals

    def __call__(self, span: ArrayLike) -> Reals:
        """Values (m,) or (m, k) at spans (m,); beyond the ends, the values at the ends."""
        at = np.clip(np.asarray(span, dtype=np.float64), self.span[0], self.span[-1])
        # span and value of each segment's polynomial, (n - 1, 4) and (n - 1, 4, ...)
        places, values = _polynomials(self.span), _polynomials(self.values)
        segment = np.clip(np.searchsorted(places[:, 0], at, side="right") - 1, 0, len(places) - 1)
        powers = _parameters_at(places[segment], at)[:, None] ** np.arange(4.0)
        found: Reals = np.einsum("mp,mp...->m...", powers, values[segment])
        for end in (0, -1):
            found[at == self.span[end]] = self.values[end]
        return found


def _polynomials(points: Reals) -> Reals:
    """Coefficients (n - 1, 4, ...) of the powers of t in [0, 1] of each segment of the spline of points (n, ...)."""
    points = np.asarray(points, dtype=np.float64)
    extended = np.concatenate([2.0 * points[:1] - points[1:2], points, 2.0 * points[-1:] - points[-2:-1]])
    windows = np.stack([extended[k : k + len(points) - 1] for k in range(4)], axis=1)
    found: Reals = np.einsum("pk,nk...->np...", _BASIS, windows)
    return found


def _parameters_at(polynomials: Reals, values: Reals) -> Reals:
    """Parameters t (m,) in [0, 1] where increasing cubics (m, 4) have values (m,)."""
    low, high = np.zeros_like(values), np.ones_like(values)
    for _ in range(BISECTIONS):
        middle = (low + high) / 2.0
        below = _horner(polynomials, middle) < values
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return (low + high) / 2.0


def _horner(polynomials: Reals, t: Reals) -> Reals:
    found: Reals = ((polynomials[:, 3] * t + polynomials[:, 2]) * t + polynomials[:, 1]) * t + polynomials[:, 0]
    return found


@dataclass(frozen=True, kw_only=True, eq=False)
class SectionValues:
    """Parameters of the m sections of a case, hub to tip."""

    span: Reals
    """(m,) from 0 to 1"""
    chord_multiplier: Reals
    """(m,) factor of the chord; 1 without a chord multiplier"""
    chord: Reals | None
    """(m,) chords in m', where the chord switch gives them; None where they follow from the edges"""
    sweep: Reals
    """(m,) shift along the streamline, in m'"""
    lean: Reals
    """(m,) shift in theta [rad]"""
    theta_offset: float
    """turn of all sections [rad]"""
    angle_in: Reals
    """(m,) metal angle at the inlet [deg], in the plane of the case's angles, incidence included; a wing's twist"""
    angle_out: Reals
    """(m,) metal angle at the exit [deg], deviation included; a wing's total camber"""
    stagger: Reals | None
    """(m,) stagger [deg], where the file gives it instead of an inlet angle"""
    meanlines: tuple[Reals, ...] | None
    """for each section control points (k, 2) of the second derivative: u, value; None for straight ends and a cubic"""
    leading_index: Reals | None
    """(m,) index I of the leading edge's radius, of the modified NACA thickness"""
    thickest: Reals
    """(m,) place of the largest thickness, of the chord"""
    thickness: Reals
    """(m,) largest thickness, of the chord"""
    leading_thickness: Reals | None
    """(m,) thickness at the leading edge, of the chord, its own table's where it is a spline; None with the NACA law"""
    trailing_thickness: Reals
    """(m,) thickness at the trailing edge, of the chord"""
    trailing_slope: Reals | None
    """(m,) slope of the half thickness at the trailing edge; None where it follows from the place of the largest"""
    multipliers: tuple[Reals, ...] | None
    """for each section control points (k, 2) of the thickness multiplier 1 + m: u, m"""
    leading_edges: Reals | None
    """(m, 13) parameters of leading edges that are splines, in the order of `LEADING_EDGE`"""


def section_spans(leading_edges: ArrayLike, *, along_axis: bool = False) -> Reals:
    """Spans (m,) of sections whose leading edges lie at (x, r) (m, 2): 0 at the first, 1 at the last.

    The radius is measured, or x where the span runs `along_axis`, as in a radial machine. Raises FileError where the
    first and the last leading edge do not differ in it.
    """
    points = np.asarray(leading_edges, dtype=np.float64)
    along = points[:, 0 if along_axis else 1]
    extent = abs(along[-1] - along[0])
    if not extent > 0.0:
        raise FileError(
            f"the leading edges of the first and the last streamline have the same {'x' if along_axis else 'radius'}: "
            "T-Blade3 measures the span by it, and there is none"
        )
    found: Reals = np.abs(along - along[0]) / extent
    return found


def section_values(case: TBlade3Case, span: ArrayLike) -> SectionValues:
    """The parameters of a case's sections, given their spans (m,), one for each."""
    at = np.asarray(span, dtype=np.float64)
    if at.shape != (len(case.sections),):
        raise FileError(f"{at.size} spans are given for the {len(case.sections)} sections of '{case.file}'")
    angle_in, angle_out = _angles(case, at)
    edges = _leading_edges(case.leading_edges, at) if case.leading_edge == "spline" else None
    multiplied, given = case.chord == "multiplied", case.chord == "given"
    return SectionValues(
        span=at,
        chord_multiplier=1.0 + _law(case.chord_multiplier, at) if multiplied else np.ones_like(at),
        chord=_column(case, "chord") if given else None,
        sweep=_law(case.sweep, at),
        lean=_law(case.lean, at),
        theta_offset=float(np.radians(case.theta_offset)),
        angle_in=angle_in,
        angle_out=angle_out,
        stagger=_law(case.in_beta, at) if case.staggers_given else None,
        meanlines=_curves(case.meanlines, at) if case.curvature_camber else None,
        multipliers=_curves(case.multipliers, at) if case.thickness_multiplier and case.thickness != "naca" else None,
        leading_edges=edges,
        **_thickness(case, at, edges),
    )


def _angles(case: TBlade3Case, at: Reals) -> tuple[Reals, Reals]:
    """Metal angles [deg] at inlet and exit: flow angles minus incidence and deviation, in the direction of turning."""
    angle_in, angle_out = _column(case, "in_beta"), _column(case, "out_beta")
    incidence, deviation = _column(case, "incidence"), _column(case, "deviation")
    if case.angle_spline == "inci_dev_spline":
        incidence, deviation = _law(case.in_beta, at), _law(case.out_beta, at)
    if case.angle_spline in {"inletspline", "inoutspline"}:
        angle_in = _law(case.in_beta, at)
    if case.angle_spline in {"outletspline", "inoutspline"}:
        angle_out = _law(case.out_beta, at)
    angle_in = np.where(angle_in >= 0.0, angle_in - incidence, angle_in + incidence)
    angle_out = np.where(angle_out - angle_in <= 0.0, angle_out - deviation, angle_out + deviation)
    return angle_in, angle_out


def _thickness(case: TBlade3Case, at: Reals, edges: Reals | None) -> dict[str, Any]:
    naca = case.naca
    if case.thickness == "naca" and naca:
        found: dict[str, Any] = {
            name: _spline(naca.span, getattr(naca, name))(at)
            for name in ("leading_index", "thickest", "thickness", "trailing_thickness")
        }
        slope = _spline(naca.span, naca.trailing_slope)(at) if naca.trailing_slope else None
        if slope is not None and naca.slope_normalised:
            slope = -found["thickness"] * slope
        return {**found, "leading_thickness": None, "trailing_slope": slope}
    thickness, thickest = _column(case, "thickness"), _column(case, "thickest")
    if case.thickness_multipliers:
        thickness = thickness * (1.0 + _law(case.thickness_multipliers, at))
    if case.thickest:
        places = _law(case.thickest, at)
        thickest = np.where(places == 0.0, thickest, places)
    return {
        "leading_index": None,
        "thickest": thickest,
        "thickness": thickness,
        "leading_thickness": _column(case, "leading_thickness") if edges is None else edges[:, 0],
        "trailing_thickness": _column(case, "trailing_thickness") if edges is None else edges[:, 1],
        "trailing_slope": None,
    }


def _curves(curves: Meanlines | Multipliers | None, at: Reals) -> tuple[Reals, ...] | None:
    if curves is None:
        return None
    values = curves.curvature if isinstance(curves, Meanlines) else curves.values
    if curves.span is None:
        return tuple(np.column_stack(pair) for pair in zip(curves.u, values, strict=True))
    found = np.stack([_spline(curves.span, table)(at) for table in (curves.u, values)], axis=-1)
    found[:, [0, -1], 0] = [0.0, 1.0]
    return tuple(found)


def _leading_edges(edges: LeadingEdges | None, at: Reals) -> Reals | None:
    if edges is None:
        return None
    return np.array(edges.values) if edges.span is None else _spline(edges.span, edges.values)(at)


def _law(law: SpanLaw, at: Reals) -> Reals:
    return _spline(law.span, law.values)(at)


def _spline(span: tuple[float, ...], values: tuple[float, ...] | Table) -> SpanSpline:
    return SpanSpline(span=np.array(span), values=np.array(values))


def _column(case: TBlade3Case, name: str) -> Reals:
    return np.array([getattr(row, name) for row in case.sections], dtype=np.float64)


@dataclass(frozen=True, kw_only=True, eq=False)
class MetalAngles:
    """Angles of the m sections [rad] in the plane (m', theta)."""

    inlet: Reals | None
    """(m,) metal angle at the leading edge; None where the stagger is given"""
    exit: Reals | None
    """(m,) metal angle at the trailing edge; None where the stagger is given"""
    camber: Reals | None
    """(m,) total camber, exit minus inlet; None where the file gives staggers instead of inlet angles"""
    stagger: Reals | None
    """(m,) stagger of a wing, or given by the file; None where it follows from the meanline"""


def metal_angles(case: TBlade3Case, values: SectionValues, phi_in: ArrayLike, phi_out: ArrayLike) -> MetalAngles:
    """The angles of the sections, given the slopes phi = atan(dr/dx) (m,) [rad] of their streamlines at both edges.

    The axial angle beta_z, at constant radius, and the radial angle beta_r, at constant x, give the angle beta on the
    stream surface: tan(beta) = tan(beta_z) cos(phi) = tan(beta_r) sin(phi). A wing's angles are used as they are.
    """
    if values.stagger is not None:
        return MetalAngles(inlet=None, exit=None, camber=None, stagger=np.radians(values.stagger))
    if case.angles == "wing":
        camber, twist = np.radians(values.angle_out), np.radians(values.angle_in)
        return MetalAngles(inlet=None, exit=None, camber=camber, stagger=twist)
    inlet = on_stream_surface(values.angle_in, phi_in, radial=case.angles in {"radial", "radial-axial"})
    end = on_stream_surface(values.angle_out, phi_out, radial=case.angles in {"radial", "axial-radial"})
    return MetalAngles(inlet=inlet, exit=end, camber=end - inlet, stagger=None)


def on_stream_surface(angle: ArrayLike, phi: ArrayLike, *, radial: bool) -> Reals:
    """Angle beta [rad] on the stream surface of an angle beta_z or, `radial`, beta_r [deg], at the slope phi [rad]."""
    part = np.sin(phi) if radial else np.cos(phi)
    found: Reals = np.arctan(np.tan(np.radians(angle)) * part)
    return found
