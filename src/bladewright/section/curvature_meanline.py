"""The curvature-meanline family: a meanline by its second derivative, or of straight ends and a cubic; a thickness law.

The meanline's second derivative along the chord is a B-spline of any number of control points. It is integrated twice,
exactly, and scaled so that the inlet and outlet metal angles are held; the stagger follows.
Reference: Nemnem et al. 2014, ASAT-16-142-PP.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Annotated, Literal

import numpy as np

from bladewright.designs import ChordwiseLaw, Law, Limits, parameter
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, degrees, radians
from bladewright.section import checks
from bladewright.section.chord_map import Breakpoint
from bladewright.section.chord_spline import ChordSpline
from bladewright.section.edge_spline import EdgeSpline
from bladewright.section.family import SectionFamily
from bladewright.section.laws import Span
from bladewright.section.meanline import (
    STRAIGHT,
    CurvedMeanline,
    Meanline,
    MixedMeanline,
    backward,
)
from bladewright.section.offset import OffsetOutline, fixed_joints
from bladewright.section.outline import Joint, Outline
from bladewright.section.planar import PlanarSection
from bladewright.section.tagged_unions import ByField
from bladewright.section.thickness.law import Thickness
from bladewright.section.thickness.modified_naca import ModifiedNaca
from bladewright.section.thickness.quartic import QuarticSpline
from bladewright.section.thickness.wennerstrom import Wennerstrom

GRID = np.linspace(0.0, 1.0, 9)
"""span fractions at which it is seen whether a joint moves: more places than a usual law has control points [-]"""
AnyThickness = Annotated[Wennerstrom | ModifiedNaca | QuarticSpline, ByField("law")]
"""One of the thickness laws, chosen by `law`."""

ANGLE = Limits(-90.0, 90.0, "an angle must lie between -90 and 90 deg")
CONTROL_POINT = Limits(-1e9, 1e9, "it must lie between -1e9 and 1e9")
PLACE = Limits(0.0, 1.0, "a place must lie between 0 and 1 chord")


@dataclass(frozen=True, kw_only=True)
class CurvatureMeanline(SectionFamily):
    """A section on a meanline of given second derivative, between given metal angles."""

    metal_angle_in: Law = parameter("deg", limits=ANGLE)
    """camber angle at the leading edge [deg]"""
    metal_angle_out: Law = parameter("deg", limits=ANGLE)
    """camber angle at the trailing edge [deg]"""
    camber: Literal["curvature", "mixed"] = "curvature"
    """curvature: by its second derivative; mixed: straight ends, 0.1 and 0.05 chords long, and a cubic between"""
    curvature: ChordwiseLaw = parameter("-", limits=CONTROL_POINT, default=())
    """control points of the meanline's second derivative, leading to trailing edge; only their ratios count [-]"""
    curvature_places: ChordwiseLaw = parameter("-", limits=PLACE, default=())
    """chord fractions of the inner control points of the second derivative; none: evenly spaced [-]"""
    thickness: AnyThickness
    """thickness law, chosen by its `law`"""
    thickness_multiplier: ChordwiseLaw = parameter("-", limits=CONTROL_POINT, default=())
    """control points of the fraction by which the half thickness grows, leading to trailing edge; none: 0 [-]"""
    thickness_multiplier_places: ChordwiseLaw = parameter("-", limits=PLACE, default=())
    """chord fractions of the inner control points of the multiplier; none: evenly spaced [-]"""
    leading_edge_spline: EdgeSpline | None = None
    """a quartic B-spline in place of the leading edge, with droop and elongation; none: the thickness law's own"""

    def __post_init__(self) -> None:
        checks.parameters(self)
        checks.choice("camber", self.camber, ["curvature", "mixed"])
        self._check_spline("curvature", 2)
        self._check_spline("thickness_multiplier", 3)
        if (self.camber == "curvature") != (len(self.curvature) > 0):
            given = "given" if self.curvature else "not given"
            cure = "leave it out, or set camber to curvature" if self.curvature else "give it, or set camber to mixed"
            raise DesignError(f"curvature is {given}, but camber is {self.camber}: {cure}")

    def _check_spline(self, name: str, least: int) -> None:
        """Refuse a row of control points and their places whose numbers do not fit."""
        places = f"{name}_places"
        count, inner = len(getattr(self, name)), len(getattr(self, places))
        if 0 < count < least:
            raise DesignError(f"{name} has {count} control points: at least {least} are needed")
        if inner and inner != count - 2:
            raise DesignError(
                f"{places} has {inner} entries for {count} control points of {name}: give {max(count - 2, 0)}, one for "
                "each but the first, at 0, and the last, at 1"
            )

    def control_places(self, row: str) -> Sequence[float] | None:
        """Both rows stand at given places."""
        if row not in ("curvature", "thickness_multiplier"):
            return None
        return np.real(self._places(row, Span(np.array([0.5]))))[0].tolist()

    def meanline(self, span: Span) -> Meanline:
        """The meanlines (..., m) at the places of the span; raises DesignError where none has the camber asked for.

        They are in chords of the section without leading_edge_spline.
        """
        angle_in, angle_out = self._angles(span)
        if self.camber == "mixed":
            stagger = 0.5 * (angle_in + angle_out)
            return MixedMeanline(angles=(angle_in - stagger, angle_out - stagger))
        places, values = self._places("curvature", span), span.control_values(self.curvature)
        line = CurvedMeanline(places=places, values=values, camber=angle_out - angle_in)
        nowhere = np.isnan(np.real(line.scale))
        if np.any(nowhere):
            missed, wanted, most = np.broadcast_arrays(nowhere, np.real(line.camber), line.largest_camber)
            first = tuple(np.argwhere(missed)[0])
            raise DesignError(
                f"metal_angle_out less metal_angle_in is {degrees(wanted[first]):.4g} deg at span fraction "
                f"{span.v[first[-1]]:.4g}: a meanline of this curvature can turn by {degrees(most[first]):.4g} deg at "
                "most, for its second derivative is zero, or changes sign and turns back what it has turned; lower the "
                "difference of the angles, or give more of the control points of curvature the same sign"
            )
        return line

    def outline(self, span: Span) -> Outline:
        """The exact sections (..., m) at the places of the span; raises DesignError where numbers contradict."""
        whole = self.unsplined(span)
        return whole if self.leading_edge_spline is None else self.leading_edge_spline.applied(whole, span)

    def unsplined(self, span: Span) -> OffsetOutline:
        """The sections without leading_edge_spline, in chords of their own."""
        meanline, thickness = self.meanline(span), self.thickness.at(span)
        kinks: tuple[Joint, ...] = ()
        if meanline.kinks:
            thickness, kinks = _with_kinks(thickness, meanline.kinks)
        return OffsetOutline(
            meanline=meanline,
            thickness=thickness,
            multiplier=self._multiplier(span) if self.thickness_multiplier else None,
            other_joints=partial(self._steady_joints, kinks),
        )

    def _steady_joints(self, kinks: Sequence[Joint]) -> tuple[Joint, ...]:
        """The kinks, and joints of the splines along the chord that are at the same s all along the span."""
        span = Span(GRID)
        thickness, found = self.thickness.at(span), [*kinks]
        if self.curvature:
            straight = CurvedMeanline(places=self._places("curvature", span), values=np.zeros(1), camber=np.zeros(1))
            found += fixed_joints(thickness, straight.joints, straight.smooth - 1)
        if self.thickness_multiplier:
            found += fixed_joints(thickness, self._multiplier(span).joints, 3)
        return tuple(found)

    def stagger(self, span: Span) -> Array:
        """Angles (..., m) of the chord lines [rad], from the metal angle and the meanline's at the leading edge.

        A tip that a leading_edge_spline has moved turns the chord line with it.
        """
        turn = self._angles(span)[0] - self.meanline(span).angle_in
        if self.leading_edge_spline is None:
            return turn
        return turn + self.leading_edge_spline.applied(self.unsplined(span), span).turned

    def _angles(self, span: Span) -> tuple[Array, Array]:
        return radians(span.values(self.metal_angle_in)), radians(span.values(self.metal_angle_out))

    def _multiplier(self, span: Span) -> ChordSpline:
        name = "thickness_multiplier"
        return ChordSpline(places=self._places(name, span), values=span.control_values(self.thickness_multiplier))

    def _places(self, name: str, span: Span) -> Array:
        """Chord fractions (..., m, n) of control points, from 0 to 1."""
        inner, count = getattr(self, f"{name}_places"), len(getattr(self, name))
        if not inner:
            return np.linspace(0.0, 1.0, count)[None]
        middle = span.control_values(inner)
        ends = np.zeros_like(middle[..., :1])
        places = np.concatenate([ends, middle, ends + 1.0], axis=-1)
        falling = np.argwhere(backward(np.real(places)))
        if len(falling):
            *where, entry = (int(each) for each in falling[0])
            entry = min(entry, len(inner) - 1)
            raise DesignError(
                f"{name}_places[{entry}] is {np.real(middle)[(*where, entry)]:.4g} at span fraction "
                f"{span.v[where[-1]]:.4g}: places must rise from the leading to the trailing edge, but for two inner "
                "ones that may be equal"
            )
        return places


def _with_kinks(thickness: Thickness, kinks: Sequence[Breakpoint]) -> tuple[Thickness, tuple[Joint, ...]]:
    """The thickness with the kinks of a meanline at fixed s, and the sides' joints there."""
    try:
        found = thickness.with_breakpoints(kinks)
    except DesignError:
        raise
    except ValueError as error:
        raise DesignError(
            "thickness.maximum_thickness_at, or the end of a round edge, lies on the wrong side of an end of the mixed "
            f"camber line's straight parts, {STRAIGHT[0]:g} chords behind the leading and {STRAIGHT[1]:g} before the "
            "trailing edge: move the maximum towards mid-chord, thin the edge, or set camber to curvature"
        ) from error
    known = {joint.s for joint in thickness.joints}
    return found, tuple(Joint(joint.s, 0) for joint in found.joints if joint.s not in known)


@dataclass(frozen=True, kw_only=True)
class CurvatureMeanlineSection(PlanarSection):
    """A section on a meanline of given second derivative, in the plane (x, y), x axial and y tangential."""

    section: CurvatureMeanline
    """meanline and thickness"""
