"""From a design to its native blade."""

from types import MappingProxyType

from bladewright.blade.design.sectioned import SectionedBlade
from bladewright.blade.design.unified import UnifiedBlade
from bladewright.blade.exact.checks import check_channel, check_clearance, check_pitch, check_sections
from bladewright.blade.exact.exact_blade import ExactBlade
from bladewright.blade.exact.sectioned import exact_sectioned_blade
from bladewright.blade.exact.unified import exact_unified_blade
from bladewright.blade.native.blade import Blade, Faces, side_surface
from bladewright.blade.native.end_faces import trimmed_ends
from bladewright.blade.native.interpolation import edge_faces, native_sides
from bladewright.blade.native.knots import DEGREE, MOST_POLES, Knots
from bladewright.blade.native.refinement import WALL_TOLERANCE, mean_chord, refined_knots
from bladewright.errors import DesignError


def built(design: UnifiedBlade, knots: Knots | None = None) -> Blade:
    """The native blade of a design, at given knots or at knots refined until its tolerance holds.

    Raises DesignError where the shape is impossible, or the tolerance is not reached within 200 x 100 poles a side.
    """
    exact = exact_unified_blade(design, None if knots is None else knots.tip)
    check_channel(exact)
    check_sections(exact)
    check_clearance(exact)
    return native_blade(exact, knots)


def built_of_sections(design: SectionedBlade, knots: Knots | None = None) -> Blade:
    """The same of a design of sections."""
    exact = exact_sectioned_blade(design)
    check_pitch(exact)
    return native_blade(exact, knots)


def native_blade(exact: ExactBlade, knots: Knots | None = None) -> Blade:
    """The native blade of what is meant, at given knots or at knots refined until the design's tolerance holds."""
    chord = mean_chord(exact)
    held = knots is not None
    knots = knots if knots is not None else refined_knots(exact, chord)
    stations = exact.stations(knots.sites_v)
    nets = native_sides(stations, knots)
    sides = side_surface(nets[0], knots, DEGREE), side_surface(nets[1], knots, DEGREE)
    edges = edge_faces(stations, *sides, knots)
    ends = trimmed_ends(exact, *sides, chord, faces=edges)
    surfaces: Faces = MappingProxyType({"upper": sides[0], "lower": sides[1], **edges, **ends})
    blade = Blade(design=exact.design, surfaces=surfaces, knots=knots, chord=chord, exact=exact)
    if not held:
        _check_reached(blade)
    return blade


def _check_reached(blade: Blade) -> None:
    tolerance, poles = blade.tolerance, blade.knots.poles
    wall = min(WALL_TOLERANCE, tolerance)
    error, off = blade.error, blade.wall_error
    if error <= tolerance and off <= wall and poles[0] <= MOST_POLES[0] and poles[1] <= MOST_POLES[1]:
        return
    if error <= tolerance and off <= wall:
        where = " and ".join(
            name for name, own, most in zip(("chord", "span"), poles, MOST_POLES, strict=True) if own > most
        )
        raise DesignError(
            f"tolerance is {tolerance:g} of the chord, which native surfaces hold with {poles[0]} x {poles[1]} poles a "
            f"side, and at most {MOST_POLES[0]} x {MOST_POLES[1]} are allowed: give the laws along the {where} fewer "
            "control points, and curves in (x, r) fewer points"
        )
    raise DesignError(
        f"tolerance is {tolerance:g} of the chord: native surfaces reach {error:.2g} (ends {off:.2g} off the "
        f"walls, {wall:g} allowed) with {poles[0]} x {poles[1]} poles a side, at most {MOST_POLES[0]} x "
        f"{MOST_POLES[1]} are allowed; the worst place is u = {blade.misfit.u:.3f}, v = {blade.misfit.v:.3f}: raise "
        "the tolerance, raise a very small edge radius, or smooth the laws there"
    )
