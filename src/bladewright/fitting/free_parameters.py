"""Which parameters of a design a fit may change, what change of each matters, and how far it may go."""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bladewright.blade.design.meridional_curve import ThroughPoints
from bladewright.blade.design.sectioned import SectionedBlade
from bladewright.blade.design.unified import UnifiedBlade
from bladewright.derivatives.patterns import Patterns, chosen, matching
from bladewright.designs import Design, Part, limits_at, unit_at, value_at
from bladewright.errors import DesignError, FitError
from bladewright.fitting.checks import is_number, refusing, texts
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import UNITS
from bladewright.section.laws import law_points
from bladewright.section.profiles.points import PointsProfile
from bladewright.section.segmented.part import Segmented

EDGES = ("leading_edge", "trailing_edge")
"""edge curves of a blade"""
WALLS = ("hub", "shroud")
"""walls of a flow path"""
NOT_IN_CLOUD = ("density", "disc", "shroud_ring", "pitch", "span", "tip_clearance", "hub_clearance")
"""fields and tables of a design that the points of one blade do not determine"""


def gauge_parameters(design: Design, *, walls: bool = False) -> frozenset[str]:
    """Paths of the parameters that a cloud cannot determine, which are held unless they are freed.

    Of any design they are the metal's density, what carries the blades, their pitch and clearances, and the span.
    Of control points that count by their ratios only it is the largest. Of points of a contour it is the coordinate
    along which they slide on it, and both coordinates of the first and the last along the chord, as their size and
    direction do not matter. Of a segmented airfoil it is the cuts, which are a choice, and where its chord line lies,
    which its joints make up for. Of a blade it is the flow path, which a blade shows by its ends only, and the
    coordinate along which the points of its edge curves slide on the curve. Where the `walls` are free, only that
    coordinate of the points of hub and shroud is held.
    """
    values, section = design.parameters(), getattr(design, "section", None)
    held = [*NOT_IN_CLOUD]
    # the whole law of the control point of the second derivative that is largest
    curvature = {path: value for path, value in values.items() if path.startswith("section.curvature[")}
    largest = max(curvature, key=lambda path: curvature[path] ** 2, default="")
    found = {path for path in curvature if path.startswith(largest.partition("]")[0] + "]")}
    if isinstance(section, Segmented):
        held += ["section.partition", "section.stagger_angle", "leading_edge_y"]
    if isinstance(section, PointsProfile):
        found |= _along_contour(section)
    if isinstance(design, SectionedBlade) or (isinstance(design, UnifiedBlade) and design.flow_path is not None):
        held.append("flow_path.")
        for edge in EDGES:
            points, along = (f"channel.{edge}", f"{edge}."), f".{sliding_coordinate(design, edge)}"
            found |= {path for path in values if path.startswith(points) and path.endswith(along)}
    found |= {path for path in values if path.startswith(tuple(held))}
    if walls and isinstance(design, SectionedBlade):
        found -= _across_walls(design)
    return frozenset(found)


def sliding_coordinate(design: SectionedBlade | UnifiedBlade, edge: str) -> str:
    """The coordinate, x or r, in which an edge curve has its extent."""
    if isinstance(design, UnifiedBlade):
        return _longer(np.array(getattr(design.channel, edge)))
    curve = getattr(design, edge)
    return "r" if curve is None else _longer(curve.line(1.0).net)


def _longer(points: Array) -> str:
    """The coordinate, x or r, in which the first and the last of points (n, 2) are farther apart."""
    across = np.real(points[-1] - points[0]) ** 2
    return "x" if across[0] > across[1] else "r"


def _across_walls(design: SectionedBlade) -> set[str]:
    """For every point of hub and shroud the coordinate, x or r, across which the wall runs there."""
    found = set()
    for wall in WALLS:
        curve = getattr(design.flow_path, wall)
        if isinstance(curve, ThroughPoints):
            way = np.gradient(np.real(np.array(curve.points)), axis=0) ** 2
            across: list[tuple[str, ...]] = [("r",) if x >= r else ("x",) for x, r in way]
            # where points at equal fractions of whole walls are joined, the shroud's ends decide which these are, so
            # that both of their coordinates are free
            if wall == "shroud" and design.flow_path.matched == "ends":
                across[0] = across[-1] = ("x", "r")
            found |= {f"flow_path.{wall}.points[{i}].{name}" for i, names in enumerate(across) for name in names}
    return found


def _along_contour(section: PointsProfile) -> set[str]:
    """Paths of coordinates that do not change a contour through points, or hardly; of laws as their means say."""
    x, y = (
        np.array([float(np.mean(np.real(law_points(each)))) for each in law])
        for law in (section.abscissas, section.ordinates)
    )
    along_x, along_y = ((np.roll(each, -1) - np.roll(each, 1)) ** 2 for each in (x, y))
    held = {f"{'abscissas' if along_x[i] >= along_y[i] else 'ordinates'}[{i}]" for i in range(len(x))}
    held |= {f"{name}[{i}]" for name in ("abscissas", "ordinates") for i in (int(np.argmin(x)), int(np.argmax(x)))}
    return {f"section.{path}" for path in section.parameters() if path.startswith(tuple(held))}


@dataclass(frozen=True, kw_only=True)
class FreeParameters:
    """Patterns of what is free, and of what is held at which values."""

    free: tuple[str, ...] | None = None
    fixed: tuple[str, ...] = ()
    values: Mapping[str, float] | None = None
    walls: bool = False
    """whether hub and shroud of a blade from sections are free too"""
    unseen: frozenset[str] = frozenset()
    """edges and walls that are cut off or behind fillets: they are held"""
    held: frozenset[str] = frozenset()
    """parameters that a search holds besides, of the free ones"""
    corners: bool = True
    """whether the radii at which a blade's edges meet hub and shroud are free"""

    def __call__(self, design: Design) -> tuple[str, ...]:
        """The free parameters of a design; raises FitError where nobody frees any, or where no point shows one."""
        paths = design.parameters()
        never = {path for path in paths if path.startswith(NOT_IN_CLOUD)}
        with refusing():
            wanted = chosen(design, self.free)
            held = never.union(*(matching(pattern, paths) for pattern in self.fixed))
            hidden = [pattern for pattern in self.free or () if never.issuperset(matching(pattern, paths))]
        if hidden:
            raise FitError(
                f"free names {', '.join(hidden)}, which the points of one blade do not show: no fit finds it, so leave "
                "it out, and give its value in the start"
            )
        if self.free is None:
            held |= gauge_parameters(design, walls=self.walls)
        held |= {path for place in self.unseen for path in parameters_of_curve(design, place)}
        found = tuple(path for path in wanted if path not in held)
        if not found:
            raise FitError("no parameter is left to fit: free at least one, or fix fewer")
        besides = self.held if self.corners else self.held.union(corner_radii(design))
        return tuple(path for path in found if path not in besides)

    def applied(self, design: Design) -> Design:
        """The design with the given values."""
        if not self.values:
            return design
        with refusing():
            known = list(design.parameters())
            changes = {path: value for pattern, value in self.values.items() for path in matching(pattern, known)}
            return design.changed(changes)


def free_parameters_of(free: Patterns, fixed: "Patterns | Mapping[str, float]", *, started: bool) -> FreeParameters:
    """The free parameters that were asked for; raises FitError where what is held has no value."""
    free = None if free is None else texts("free", free)
    names = () if fixed is None else texts("fixed", fixed)
    if isinstance(fixed, Mapping):
        return FreeParameters(free=free, fixed=names, values=dict(fixed))
    if (names or free is not None) and not started:
        held = names[0] if names else "what is not free"
        raise FitError(f"{held} is to be held, but has no value: give a start design, or the value itself")
    return FreeParameters(free=free, fixed=names)


def corner_radii(design: Design) -> tuple[str, ...]:
    """Paths of the radii at which a blade's edges meet hub and shroud."""
    if not isinstance(design, UnifiedBlade):
        return ()
    return tuple(f"{corner}.r" for wall in WALLS for corner in _corners(design, wall))


def _corners(design: UnifiedBlade, wall: str) -> list[str]:
    """Paths of the points at which a blade's edges meet hub or shroud."""
    lasts = {edge: len(getattr(design.channel, edge)) - 1 for edge in EDGES}
    return [f"channel.{edge}[{last if wall == 'shroud' else 0}]" for edge, last in lasts.items()]


def parameters_of_curve(design: Design, name: str) -> frozenset[str]:
    """Paths of the parameters of an edge or a wall of a blade; of a channel's corners, across the wall."""
    paths = [p for p in design.parameters() if p.startswith((f"channel.{name}", f"flow_path.{name}", f"{name}."))]
    if isinstance(design, UnifiedBlade) and name in WALLS:
        corners = _corners(design, name)
        across = "r" if _longer(np.array([value_at(design, corner) for corner in corners])) == "x" else "x"
        paths += [f"{corner}.{across}" for corner in corners]
    return frozenset(paths)


SMALLEST_LENGTH = 2e-5
"""smallest thickness and edge radius, of the chord: about what can be made (design/matching_constants.md)"""
LARGEST_ANGLE = 89.0
"""largest angle [deg]: at 90 deg the tangent that places the camber is infinite (design/matching_constants.md)"""


class ParameterRange(NamedTuple):
    """Of one parameter, in the unit of its field."""

    size: float
    """a change that matters"""
    low: float = -np.inf
    high: float = np.inf


ON_BOUND = 1e-9
"""distance from a bound, of a parameter's scale, within which it is held by it (design/matching_constants.md)"""
INSIDE = 1e-3
"""how far inside its field's limits a parameter stays, of its size, for derivatives (design/matching_constants.md)"""

RANGES: tuple[tuple[str, Callable[[float, float], ParameterRange]], ...] = (
    ("metal_angle_.*", lambda *_: ParameterRange(10.0, -LARGEST_ANGLE, LARGEST_ANGLE)),
    ("leading_edge_theta|stacking.theta", lambda *_: ParameterRange(float(np.degrees(0.05)))),
    (".*wedge.*", lambda *_: ParameterRange(3.0, 0.0, LARGEST_ANGLE)),
    ("tangent_(in|out)", lambda *_: ParameterRange(0.2, 0.05, 1.0)),
    (".*_tangent_(in|out)", lambda value, _: ParameterRange(float(np.clip(0.5 * value, 2e-3, 0.05)), 1e-3)),
    (".*(abscissas|ordinates)", lambda *_: ParameterRange(0.01)),
    (".*(suction|pressure)_places", lambda *_: ParameterRange(0.05)),
    (
        ".*(camber_position|front_camber|uniform_load|transition|thickness_at|multiplier|edge_slope)",
        lambda *_: ParameterRange(0.1),
    ),
    (".*(camber|edge_curvature|heights)", lambda *_: ParameterRange(0.02)),
    (".*(lift_coefficient|design_lift|slope_factor)", lambda *_: ParameterRange(0.3)),
    (".*radius", lambda _, largest: ParameterRange(max(0.5 * largest, 1e-3), SMALLEST_LENGTH, 0.999)),
    ("thickness_(upper|lower)", lambda _, largest: ParameterRange(max(0.5 * largest, 0.02), SMALLEST_LENGTH, 5.0)),
    (".*thickness", lambda _, largest: ParameterRange(max(0.5 * largest, 0.01), SMALLEST_LENGTH)),
    (".*(stretch|scale)", lambda *_: ParameterRange(0.3, 0.05)),
    (".*index", lambda *_: ParameterRange(1.0, 0.05)),
    (".*skew", lambda *_: ParameterRange(0.2, -0.95, 0.95)),
    (".*ratio", lambda *_: ParameterRange(0.5, 0.05)),
    (".*places", lambda *_: ParameterRange(0.05, 1e-3, 1.0 - 1e-3)),
    (".*weights.*", lambda value, _: ParameterRange(0.5 * value, 1e-2 * value, 1e2 * value)),
)
"""by names of fields, lengths apart, from a value and the largest magnitude in its field; the first match counts"""


@cache
def _range_rule(name: str) -> Callable[[float, float], ParameterRange] | None:
    return next((rule for names, rule in RANGES if re.fullmatch(names, name)), None)


def parameter_range(of: Part, path: str, value: float, largest: float, chord: float = 1.0) -> ParameterRange:
    """The range of a parameter of a design, of a chord in its own unit, or a part; `largest` magnitude in its field."""
    name, unit = re.sub(r"\[\d+\]|\.values", "", path), unit_at(of, path)
    rule = None if unit == "length" else _range_rule(name)
    if rule is not None:
        found = rule(value, largest)
    elif unit == "length":
        along_curve = path.startswith(("channel", "flow_path.", "leading_edge.", "trailing_edge."))
        least = 1e-3 * chord if name == "axial_chord" else -np.inf
        found = ParameterRange((0.02 if along_curve else 0.05) * chord, least)
    elif unit == "deg":
        found = ParameterRange(5.0, -LARGEST_ANGLE, LARGEST_ANGLE)
    else:
        found = ParameterRange(max(0.3 * largest, 0.02))
    limits = limits_at(of, path)
    if limits is None or (isinstance(of, Design) and not path.startswith("section.")):
        return found
    inside = 0.0 if limits.closed else INSIDE * found.size
    return ParameterRange(found.size, max(found.low, limits.low + inside), min(found.high, limits.high - inside))


@dataclass(frozen=True, kw_only=True, eq=False)
class Scales:
    """Of k parameters, in the units of their fields."""

    size: Reals
    """(k,) a change that matters: the unit of a search, and how far a first guess may be off"""
    low: Reals
    """(k,) lowest values"""
    high: Reals
    """(k,) highest values"""

    def inside(self, values: Reals) -> NDArray[np.bool_]:
        """Which of the parameters (k,) lie on none of their bounds, apart from rounding."""
        return np.minimum(values - self.low, self.high - values) > ON_BOUND * self.size


def scales_of(
    design: Design, paths: Sequence[str], chord: float, bounds: Mapping[str, tuple[float, float]] | None = None
) -> Scales:
    """Scales of a design's parameters; `chord` in metres, `bounds` by pattern within those of the family."""
    kinds = _ranges(design, paths, chord)
    size, low, high = (np.array([getattr(kind, name) for kind in kinds]) for name in ("size", "low", "high"))
    for pattern, (least, most) in (bounds or {}).items():
        # a structure may have no such parameter
        with suppress(DesignError):
            for i in map(paths.index, matching(pattern, paths)):
                low[i], high[i] = max(low[i], least), min(high[i], most)
    return Scales(size=size, low=low, high=high)


def given_bounds(given: Any) -> dict[str, tuple[float, float]]:
    """The bounds that were asked for, infinite where one is None; refuse those of no shape, or in the wrong order."""
    given = {} if given is None else given
    if not isinstance(given, Mapping):
        raise FitError(
            f"bounds are {given!r}: a mapping from patterns to pairs is needed, such as {{'stagger': (5, 9)}}"
        )
    bounds = dict[str, tuple[float, float]]()
    for pattern, pair in zip(texts("bounds", given), given.values(), strict=True):
        ends = tuple(pair) if isinstance(pair, Iterable) else ()
        if len(ends) != 2 or not all(each is None or is_number(each) for each in ends):
            raise FitError(
                f"the bounds of {pattern} are {pair!r}: the lowest and the highest value are needed, such as (5, 9), "
                "or None for one that is open"
            )
        least, most = (-np.inf if ends[0] is None else float(ends[0])), (np.inf if ends[1] is None else float(ends[1]))
        if not least < most:
            raise FitError(f"the bounds of {pattern} are {least:g} to {most:g}: the first must be below the second")
        bounds[pattern] = least, most
    return bounds


def check_bounds(design: Design, paths: Sequence[str], bounds: Mapping[str, tuple[float, float]]) -> None:
    """Refuse bounds of no free parameter (k,), or outside what the family allows."""
    for pattern, (least, most) in bounds.items():
        try:
            matched = matching(pattern, paths)
        except DesignError as error:
            with suppress(DesignError):
                matching(pattern, design.parameters())
                raise FitError(
                    f"'{pattern}' is held and has bounds at once: it is fixed, or not among what is free; leave its "
                    "bounds out, or let it change"
                ) from error
            raise FitError(f"bounds: {error}") from error
        for path, kind in zip(matched, _ranges(design, matched, 1.0), strict=True):
            if not max(kind.low, least) < min(kind.high, most):
                raise FitError(
                    f"the bounds of {path} are {least:g} to {most:g}, and the family allows {kind.low:g} to "
                    f"{kind.high:g}: let them overlap"
                )


def _ranges(design: Design, paths: Sequence[str], chord: float) -> list[ParameterRange]:
    """Ranges of parameters; a law's sizes follow from the largest magnitude in all of it. `chord` in metres."""
    values, largest = design.parameters(), dict[str, float]()
    for path, value in values.items():
        name = path.partition("[")[0]
        largest[name] = max(largest.get(name, 0.0), abs(float(value)))
    length = chord / UNITS[getattr(design, "length_unit")]  # noqa: B009 - a field of every family, not of the base
    return [
        parameter_range(design, path, float(values[path]), largest[path.partition("[")[0]], length) for path in paths
    ]
