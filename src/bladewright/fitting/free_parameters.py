"""Which parameters of a design a fit may change, whatever its structure."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from bladewright.blade.design.meridional_curve import ThroughPoints
from bladewright.blade.design.sectioned import SectionedBlade
from bladewright.blade.design.unified import UnifiedBlade
from bladewright.derivatives.patterns import Patterns, chosen, matching
from bladewright.designs import Design, value_at
from bladewright.errors import FitError
from bladewright.fitting.checks import refusing, texts
from bladewright.numerics.elementary import Array
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
    found = _largest_curvature(values)
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


def _largest_curvature(values: Mapping[str, float]) -> set[str]:
    """The whole law of the control point of the second derivative that is largest."""
    found = {path: value for path, value in values.items() if path.startswith("section.curvature[")}
    largest = max(found, key=lambda path: found[path] ** 2, default="")
    return {path for path in found if path.startswith(largest.partition("]")[0] + "]")}


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
