"""Native blades that interpolate a shape cut from other native sides."""

from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING, cast

import numpy as np

from bladewright.blade.native.blade import Blade, Faces, side_surface
from bladewright.blade.native.cut_faces import Walls, arcs_of, around, closing_faces
from bladewright.blade.native.end_faces import EDGES
from bladewright.blade.native.interpolation import edge_faces, native_sides
from bladewright.blade.native.knots import DEGREE, MOST_POLES, Knots
from bladewright.blade.native.lazy_faces import LazyFaces
from bladewright.blade.native.refinement import Interpolated, approximation_error, refined_knots_of, wall_tolerance
from bladewright.blade.native.stretch import CutChoices
from bladewright.errors import DesignError
from bladewright.frozen import FrozenMapping
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.surface import Surface

if TYPE_CHECKING:
    from bladewright.blade.design.row_design import RowDesign

SHARE = 0.5
"""Share of the design's tolerance by which sides may differ from the blade that they are cut from: a blade is refitted
at most twice, for its edges and for its ends."""
ON_CUT = 1e-8
"""Largest distance of a cut edge from the surface that cuts it [chords]: the faces there meet as those at walls do."""
SURVEYED = 17
"""Curves of constant v on which knots along u are chosen."""


def recut(
    shape: Interpolated,
    blade: Blade,
    design: "RowDesign",
    knots: Knots | None,
    *,
    walls: Walls,
    choices: CutChoices,
    fine: bool,
    edges: float | None = None,
    tip: Reals | None = None,
) -> Blade:
    """The native blade of a shape cut from a blade, at held knots or at knots refined within the design's tolerance.

    `walls` are the meridians of ends and edges that are cut, `edges` the distance [chords] that edges may be off
    theirs, `tip` the knots of the meridian of a clearance surface. Raises DesignError where the tolerance is missed.
    """
    chord = float(np.real(blade.chord))
    allowed, off_walls = SHARE * design.tolerance * chord, wall_tolerance(chord, fine=fine)
    own = knots
    if own is None:
        on_edges = None if edges is None else min(edges * chord, off_walls)
        shaped = [edge not in walls for edge in EDGES]
        u, v, _ = refined_knots_of(
            shape, allowed, chord, walls=off_walls, edges=on_edges, shaped=(shaped[0], shaped[1])
        )
        own = Knots(u=u, v=v, tip=tip, cut=choices, before=blade.knots)
    sections = shape.sections(own.sites_v)
    upper, lower = (side_surface(net, own, DEGREE) for net in native_sides(sections, own))
    if knots is None:
        _check_reached(shape, design, own, (upper, lower), (allowed, off_walls), chord)
    native = edge_faces(sections, upper, lower, own)
    arcs = arcs_of((upper, lower), walls, revolved=blade.plain.exact.mapping.revolved)
    outlines = {name: around((upper, lower), native, arcs, row) for name, row in zip(design.ends, (0, -1), strict=True)}
    trimmed = partial(closing_faces, blade, (upper, lower), arcs, outlines, walls)
    own_faces = {"upper": upper, "lower": lower, **native}
    faces: Faces = LazyFaces(own_faces, (*own_faces, *arcs, *design.ends), trimmed)
    if not np.iscomplexobj(upper.control_points):
        faces = FrozenMapping({**own_faces, **trimmed()})
    return Blade(
        design=design,
        surfaces=faces,
        knots=own,
        chord=blade.chord,
        exact=blade.exact,
        before=blade,
        outlines=FrozenMapping(outlines),
        walls=FrozenMapping(walls),
        edges=tuple(arc for both in arcs.values() for arc in both),
    )


def native_faces(blade: Blade) -> Mapping[str, Surface]:
    """The faces of blunt edges that no cut has made."""
    return {
        name: cast("Surface", blade.surfaces[name])
        for name in EDGES
        if name in blade.surfaces and name not in blade.walls
    }


def survey_places(knots: Reals) -> Reals:
    """Places along v for a survey: evenly, and where the sides lose derivatives."""
    levels, counts = np.unique(knots, return_counts=True)
    return np.union1d(np.linspace(0.0, 1.0, SURVEYED), levels[counts > 1])


def _check_reached(
    shape: Interpolated,
    design: "RowDesign",
    knots: Knots,
    sides: tuple[Surface, Surface],
    limits: tuple[float, float],
    chord: float,
) -> None:
    found, poles = approximation_error(shape, *sides), knots.poles
    if (
        found.distance <= limits[0]
        and found.off_walls <= limits[1]
        and poles[0] <= MOST_POLES[0]
        and poles[1] <= MOST_POLES[1]
    ):
        return
    raise DesignError(
        f"cut: the cut blade is to be within {SHARE:g} of the tolerance of {design.tolerance:g} of the chord: native "
        f"surfaces reach {found.distance / chord:.2g} (ends {found.off_walls / chord:.2g} off the walls, "
        f"{limits[1] / chord:.2g} allowed) with {poles[0]} x {poles[1]} poles a side, at most {MOST_POLES[0]} x "
        f"{MOST_POLES[1]} are allowed; the worst place is u = {found.u:.3f}, v = {found.v:.3f}: raise the tolerance, "
        "let a cut's curve begin and end well clear of the blade, or smooth it or the laws there"
    )
