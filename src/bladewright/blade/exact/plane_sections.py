"""Sections of the exact blade as curves in their plane."""

from collections.abc import Callable
from types import MappingProxyType
from typing import cast

import numpy as np

from bladewright.blade.exact.exact_blade import ExactBlade
from bladewright.blade.exact.family_sections import FamilySections
from bladewright.blade.exact.sectioned import ExactSectionedBlade
from bladewright.blade.exact.unified import UnifiedSections
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array
from bladewright.section.laws import Span
from bladewright.section.native import knots_for, native_section
from bladewright.section.section import Section
from bladewright.section.smoothness import Smoothness, smoothness
from bladewright.section.unified_sides import camber_curve, side_curve

TOLERANCE = 1e-10
"""distance of a family's native curves from the exact section, of the chord"""


def section_at(exact: ExactBlade, v: float) -> Section:
    """The exact section at v in [0, 1]; raises DesignError outside."""
    if not 0.0 <= v <= 1.0:
        raise DesignError(f"a section was asked at v = {v:g}: v runs from 0 at the blade's hub end to 1 at its other")
    stations = exact.stations(np.array([v]))
    lines = stations.lines

    def scale(abscissa: Array) -> Array:
        u = lines.u_at(np.atleast_1d(abscissa)[None])
        speed = np.sqrt(np.sum(lines.position(u, 1) ** 2, axis=-1))
        return (speed / lines.densities(u)[0])[0]

    if not isinstance(stations, UnifiedSections):
        return _of_family(exact, v, scale)
    plane = stations.plane
    ends = plane.camber[0, [0, 3]]
    return Section(
        span=v,
        plane=exact.mapping.plane,
        curves=MappingProxyType({"upper": side_curve(plane.upper[0]), "lower": side_curve(plane.lower[0])}),
        camber=camber_curve(plane.camber[0]),
        stagger=float(np.real(np.arctan((ends[1, 1] - ends[0, 1]) / (ends[1, 0] - ends[0, 0])))),
        metal_angle_in=float(np.real(stations.angle_in[0])),
        metal_angle_out=float(np.real(stations.angle_out[0])),
        scale=scale,
    )


def smoothness_at(exact: ExactBlade, v: float) -> Smoothness:
    """Curvature, its slope and their jumps along the exact section at v in [0, 1], in chords of its plane."""
    stations = exact.stations(np.array([v]))
    if isinstance(stations, UnifiedSections):
        return smoothness(section_at(exact, v))
    return smoothness(_laid(exact, v).plane.outline)


def _of_family(exact: ExactBlade, v: float, scale: Callable[[Array], Array]) -> Section:
    at, part, plane = np.array([v]), exact.design.section, _laid(exact, v).plane
    turn, chord, start = (np.ravel(each)[0] for each in (plane.stagger, plane.chord, plane.start))
    return native_section(
        plane.outline,
        knots_for(plane.outline, TOLERANCE),
        turn=turn,
        chord=chord,
        shift=np.array([0.0, start]),
        span=v,
        plane=exact.mapping.plane,
        scale=scale,
        meanline=part.meanline(Span(at)),
    )


def _laid(exact: ExactBlade, v: float) -> FamilySections:
    """The family's section at v; DesignError where the blade has none there."""
    own = cast(ExactSectionedBlade, exact)
    if own.design.skinning != "sections" and v not in own.section_spans:
        where = "hub and shroud" if own.design.skinning == "ruled" else "the hub"
        raise DesignError(
            f"a section was asked at v = {v:g} of a blade whose skinning is '{own.design.skinning}': it has the "
            f"design's sections at {where} alone; ask there, or take skinning = 'sections'"
        )
    return own.sections(np.array([v]))
