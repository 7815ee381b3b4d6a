"""Parameters of a family's design that a cloud does not tell, and that stand where they are unless they are freed."""

import re

import numpy as np

from bladewright.blade.meridian import ThroughPoints
from bladewright.blade.sectioned import SectionedBlade
from bladewright.designs import Design
from bladewright.section.profiles.points import PointsProfile

EDGES = ("leading_edge", "trailing_edge")
WALLS = ("hub", "shroud")


def standing(design: Design, *, walls: bool = False) -> frozenset[str]:
    """Paths of what is held.

    Of control points that count by their ratios alone it is the largest. Of points of a contour it is the coordinate
    along which they slide on it, and both of its first and last along the chord, as their size and direction count for
    nothing. Of a blade it is the flow path, which a blade shows by its ends only, and that coordinate of the points of
    its edge curves along which they slide on the curve. Where the `walls` are free, of the points of hub and shroud
    only that coordinate is held along which they slide on these.
    """
    section = getattr(design, "section", None)
    if section is None:
        return frozenset()
    found = {f"section.{path}" for path in _largest(section.parameters())}
    if isinstance(section, PointsProfile):
        found |= _along_contour(section)
    if isinstance(design, SectionedBlade):
        values = design.parameters()
        found |= {path for path in values if path.startswith("flow_path.")}
        found -= _across_walls(design) if walls else frozenset()
        for edge in EDGES:
            along = sliding(design, edge)
            found |= {path for path in values if path.startswith(f"{edge}.") and path.endswith(f".{along}")}
    return frozenset(found)


def sliding(design: SectionedBlade, edge: str) -> str:
    """The coordinate, x or r, in which an edge curve has its extent."""
    curve = getattr(design, edge)
    if curve is None:
        return "r"
    points = np.real(curve.line(1.0).net[[0, -1]])
    across = (points[1] - points[0]) ** 2
    return "x" if across[0] > across[1] else "r"


def _across_walls(design: SectionedBlade) -> frozenset[str]:
    """Of every point of hub and shroud the coordinate, x or r, across which the wall runs there."""
    found = set()
    for wall in WALLS:
        curve = getattr(design.flow_path, wall)
        if isinstance(curve, ThroughPoints):
            points = np.array([[float(np.real(each.x)), float(np.real(each.r))] for each in curve.points])
            way = np.gradient(points, axis=0) ** 2
            across = np.where(way[:, 0] >= way[:, 1], "r", "x")
            found |= {f"flow_path.{wall}.points[{i}].{name}" for i, name in enumerate(across)}
    return frozenset(found)


def _along_contour(section: PointsProfile) -> set[str]:
    """Paths of what does not change a contour through points, or hardly does."""
    if any(isinstance(law, tuple) for law in (*section.abscissas, *section.ordinates)):
        return set()
    x, y = (np.array([float(np.real(each)) for each in law]) for law in (section.abscissas, section.ordinates))
    along_x, along_y = ((np.roll(each, -1) - np.roll(each, 1)) ** 2 for each in (x, y))
    found = {f"section.{'abscissas' if along_x[i] >= along_y[i] else 'ordinates'}[{i}]" for i in range(len(x))}
    ends = int(np.argmin(x)), int(np.argmax(x))
    return found | {f"section.{name}[{i}]" for name in ("abscissas", "ordinates") for i in ends}


def _largest(values: dict[str, float]) -> list[str]:
    """The whole law of the control point of the second derivative that is largest."""
    found = {path: value for path, value in values.items() if re.match(r"curvature\[", path)}
    if not found:
        return []
    of = max(found, key=lambda path: found[path] ** 2)
    stem = re.match(r"curvature\[\d+\]", of)
    return [path for path in found if stem is not None and path.startswith(stem[0])]
