"""From a design to its native blade."""

from types import MappingProxyType

from bladewright.blade.blade import Blade, surface_of
from bladewright.blade.checks import check_channel, check_sections
from bladewright.blade.ends import trimmed_end
from bladewright.blade.exact import exact_blade
from bladewright.blade.fitness import WALL_TOLERANCE, chord_of, error_of, knots_for
from bladewright.blade.knots import DEGREE, MOST_POLES, Knots
from bladewright.blade.native import native_sides
from bladewright.blade.unified import UnifiedBlade
from bladewright.errors import DesignError


def built(design: UnifiedBlade, knots: Knots | None = None) -> Blade:
    """The native blade of a design, at given knots or at knots refined until its tolerance holds.

    Raises DesignError where the shape is impossible, or the tolerance is not reached within 200 x 100 poles a side.
    """
    exact = exact_blade(design)
    check_channel(exact)
    check_sections(exact)
    chord = chord_of(exact)
    held = knots is not None
    knots = knots if knots is not None else knots_for(exact, chord)
    nets = native_sides(exact.stations(knots.sites_v), knots)
    sides = surface_of(nets[0], knots, DEGREE), surface_of(nets[1], knots, DEGREE)
    error, off, place = (value / chord if i < 2 else value for i, value in enumerate(error_of(exact, *sides)))
    if not held:
        _check_reached(design, knots, error, off, place)
    surfaces = {"upper": sides[0], "lower": sides[1]}
    for wall in ("hub", "shroud"):
        surfaces[wall] = trimmed_end(exact, sides, wall, chord)
    return Blade(
        design=design,
        surfaces=MappingProxyType(surfaces),
        knots=knots,
        chord=chord,
        error=error,
        wall_error=off,
        exact=exact,
    )


def _check_reached(
    design: UnifiedBlade, knots: Knots, error: float, off: float, place: tuple[float, float]
) -> None:
    wall = min(WALL_TOLERANCE, design.tolerance)
    if error <= design.tolerance and off <= wall and knots.poles[0] <= MOST_POLES[0] and knots.poles[1] <= MOST_POLES[1]:
        return
    raise DesignError(
        f"tolerance is {design.tolerance:g} of the chord: the native surfaces reach {error:.2g} (ends {off:.2g} off the "
        f"walls, {wall:g} allowed) with {knots.poles[0]} x {knots.poles[1]} poles a side, at most {MOST_POLES[0]} x "
        f"{MOST_POLES[1]} are allowed; the worst place is u = {place[0]:.3f}, v = {place[1]:.3f}: raise the tolerance, "
        "raise a very small edge radius, or smooth the laws there"
    )
