"""The flow domain about a 2D section in a cascade, as curves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from bladewright.display import Shown
from bladewright.domain.extents import MAX_EXTENT, USUAL
from bladewright.errors import DesignError
from bladewright.frozen import FrozenMapping, FrozenRecord
from bladewright.numerics.elementary import Array, radians
from bladewright.numerics.quadrature import panels
from bladewright.nurbs.basis import breaks
from bladewright.nurbs.compatible import joined
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.revolution import segment
from bladewright.nurbs.transform import translated
from bladewright.section.checks import between, number
from bladewright.section.section import Section

PLACES = 401
"""Points of each side whose distance from the camber line is compared with half the pitch; the line has four times as
many."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SectionPassage(FrozenRecord, Shown):
    """The flow domain about one section: half a pitch to each side of its continued camber line."""

    dimension: ClassVar[int] = 2
    shown_as: ClassVar[str] = "section passage"

    section: Section
    curves: Mapping[str, Curve]
    """`inlet` and `outlet` (from the lower to the upper periodic boundary), `periodic_lower` and `periodic_upper` (from
    inlet to outlet), and the section's own `upper` and `lower`; metres"""

    def __repr__(self) -> str:
        return f"<SectionPassage: {', '.join(self.curves)}; area {float(np.real(self.area)):.6g} m2>"

    @cached_property
    def area(self) -> Array:
        """Area () of the domain [m^2], by Green's theorem: the pitch times its axial extent, less the section."""
        signs = {"periodic_lower": 1.0, "outlet": 1.0, "periodic_upper": -1.0, "inlet": -1.0}
        total: Array = np.zeros(())
        for name, sign in signs.items():
            curve = self.curves[name]
            u, weight = panels(breaks(curve.knots), curve.degree + 1)
            total = total - sign * np.sum(weight * curve(u)[:, 1] * curve.derivative(u)[:, 0])
        return total - self.section.area


def section_passage(
    section: Section,
    pitch: complex,
    *,
    upstream: complex = USUAL,
    downstream: complex = USUAL,
    inlet_angle: complex | None = None,
    outlet_angle: complex | None = None,
) -> SectionPassage:
    """The flow domain about a section whose neighbours stand `pitch` [m] apart.

    The periodic boundaries are cubic B-splines: the camber line, continued by `upstream` and `downstream` axial chords
    without a change of slope, or to `inlet_angle` and `outlet_angle` [deg], half a pitch up and down. All numbers may
    be complex. Raises DesignError where an extent, an angle or the pitch is out of bounds, or a side of the section
    stands outside its passage. Agromayor et al. 2021, section 3.
    """
    between("pitch", number("pitch", pitch), 0.0, float("inf"), "it must be positive")
    for name, extent in (("upstream", upstream), ("downstream", downstream)):
        between(
            name, number(name, extent), 0.0, MAX_EXTENT, f"it must be positive and below {MAX_EXTENT:g} axial chords"
        )
    for name, angle in (("inlet_angle", inlet_angle), ("outlet_angle", outlet_angle)):
        if angle is not None:
            between(name, number(name, angle), -89.0, 89.0, "it must lie between -89 and 89 deg, as flow goes onwards")
    camber = section.camber
    chord = camber.control_points[-1, 0] - camber.control_points[0, 0]
    before = _continued(camber, 0, -upstream * chord, inlet_angle)
    after = _continued(camber, -1, downstream * chord, outlet_angle)
    middle = joined((before, camber, after))
    half = np.array([0.0, 0.5 * pitch])
    lower, upper = translated(middle, -half), translated(middle, half)
    _check_within(section, middle, float(np.real(pitch)) / 2.0)
    ends = {
        name: segment(lower.control_points[at], upper.control_points[at]) for name, at in (("inlet", 0), ("outlet", -1))
    }
    curves = {**ends, "periodic_lower": lower, "periodic_upper": upper, **section.curves}
    return SectionPassage(section=section, curves=FrozenMapping(curves))


def _continued(camber: Curve, end: int, extent: complex, degrees: complex | None) -> Curve:
    """The cubic that continues a camber line by an axial extent, its slope linear in the square of the distance."""
    start = camber.control_points[end]
    along = start - camber.control_points[1] if end == 0 else start - camber.control_points[-2]
    slope = along[1] / along[0]
    turn = slope if degrees is None else np.tan(radians(np.asarray(degrees)))
    rise = np.array([0.0, slope / 3.0, 2.0 * slope / 3.0, slope + (turn - slope) / 3.0]) * extent
    points = start + np.stack([extent * np.array([0.0, 1.0, 2.0, 3.0]) / 3.0, rise], axis=-1)
    knots = np.array([0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0])
    return Curve(control_points=points[::-1] if end == 0 else points, knots=knots, degree=3)


def _check_within(section: Section, middle: Curve, half: float) -> None:
    line = np.real(middle(np.linspace(*middle.domain, 4 * PLACES)))
    for name, sign in (("upper", 1.0), ("lower", -1.0)):
        side = np.real(section.curves[name](np.linspace(0.0, 1.0, PLACES)))
        outside = float(np.max(sign * (side[:, 1] - np.interp(side[:, 0], line[:, 0], line[:, 1])))) - half
        if outside >= 0.0:
            raise DesignError(
                f"pitch is {2.0 * half:g} m: the {name} side of the section stands {outside:.4g} m outside its "
                f"passage, which reaches {half:g} m to each side of the camber line; take a larger pitch or a thinner "
                "section"
            )
