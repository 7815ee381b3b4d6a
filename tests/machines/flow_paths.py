"""Flow paths of every kind of machine and of every kind of curve, each with edge curves of a blade in it."""

from dataclasses import dataclass, replace

import numpy as np

from bladewright.blade.design.flow_path import FlowPath
from bladewright.blade.design.meridional_curve import ControlPolygon, StraightsAndArcs, ThroughPoints
from bladewright.blade.exact.prescribed_edges import PrescribedEdges
from bladewright.blade.flow_path.stream_surfaces import stream_surfaces
from bladewright.designs import Part


@dataclass(frozen=True, kw_only=True)
class Machine(Part):
    """A flow path and a blade's edges."""

    path: FlowPath
    leading_edge: ThroughPoints | ControlPolygon
    trailing_edge: ThroughPoints | ControlPolygon

    def surfaces(self, **options):
        return stream_surfaces(self.path, 1.0, (self.leading_edge, self.trailing_edge), **options)

    def bladed(self, **options):
        edges = self.leading_edge.line(1.0), self.trailing_edge.line(1.0)
        return PrescribedEdges(surfaces=self.surfaces(**options), leading_edge=edges[0], trailing_edge=edges[1])


def through(*points, **options):
    return ThroughPoints(points=points, **options)


def on(*points, **options):
    return ControlPolygon(control_points=points, **options)


def cornered(*corners, radii=()):
    return StraightsAndArcs(corners=corners, radii=radii)


def bend(radius, centre=(0.0, 3.0)):
    """A quarter of a circle from axial to radial, its centre to the left."""
    x, r = centre
    return cornered((x, r - radius), (x + radius, r - radius), (x + radius, r), radii=(radius,))


def arcs_between(first, second, count):
    """Points of a fan of lines between two meridians' points, for stream surfaces that are given."""
    shares = np.linspace(0.0, 1.0, count)[1:-1]
    return [
        [tuple((1.0 - w) * np.array(a) + w * np.array(b)) for a, b in zip(first, second, strict=True)] for w in shares
    ]


_HUB = [(-0.4, 0.40), (0.0, 0.42), (0.3, 0.5), (0.6, 0.54), (1.0, 0.55)]
_SHROUD = [(-0.5, 1.0), (0.0, 0.99), (0.4, 0.93), (0.7, 0.9), (1.1, 0.9)]

CYLINDER = Machine(
    path=FlowPath(hub=through((-1, 1), (2, 1)), shroud=through((-1, 2), (2, 2))),
    leading_edge=through((0, 1), (0, 2)),
    trailing_edge=through((1, 1), (1, 2)),
)
CONE = Machine(
    path=FlowPath(hub=through((0, 1), (2, 2)), shroud=through((0, 2), (2, 3))),
    leading_edge=through((0.5, 1.25), (0.5, 2.25)),
    trailing_edge=through((1.5, 1.75), (1.5, 2.75)),
)
BEND = Machine(
    path=FlowPath(hub=bend(2.0), shroud=bend(1.0)),
    leading_edge=on((0.3, 0.9), (0.3, 2.1)),
    trailing_edge=on((2.1, 2.5), (0.9, 2.5)),
)
DUCT = Machine(
    path=FlowPath(
        hub=cornered((-0.5, 1.0), (1.6, 1.0), (2.0, 3.4), radii=(1.2,)),
        shroud=cornered((-0.5, 2.0), (0.6, 2.0), (1.0, 3.4), radii=(0.5,)),
    ),
    leading_edge=on((0.1, 0.9), (0.0, 2.1)),
    trailing_edge=on((2.1, 3.05), (0.8, 3.0)),
)
DISC = Machine(
    path=FlowPath(hub=through((0.5, 1), (0.5, 3)), shroud=through((0.25, 1), (0.25, 3))),
    leading_edge=through((0.5, 1.5), (0.25, 1.5)),
    trailing_edge=through((0.5, 2.5), (0.25, 2.5)),
)
IMPELLER = Machine(
    path=FlowPath(
        hub=on((-0.03, 0.02), (0.0, 0.02), (0.035, 0.022), (0.048, 0.04), (0.05, 0.07), (0.05, 0.11), degree=4),
        shroud=through((-0.03, 0.055), (0.0, 0.055), (0.02, 0.058), (0.034, 0.07), (0.042, 0.09), (0.043, 0.11)),
        quasi_orthogonals=((0.30, 0.34), (0.62, 0.60)),
    ),
    leading_edge=on((0.002, 0.019), (0.0, 0.04), (0.004, 0.056)),
    trailing_edge=through((0.0502, 0.1), (0.0415, 0.101)),
)
GIVEN = Machine(
    path=FlowPath(
        hub=through(*_HUB, spacing="conformal", ends="released"),
        shroud=through(*_SHROUD, spacing="conformal", ends="released"),
        stream_surfaces=tuple(
            through(*points, spacing="conformal", ends="released") for points in arcs_between(_HUB, _SHROUD, 5)
        ),
    ),
    leading_edge=through((0.0, 0.4), (0.02, 0.7), (0.06, 1.0), ends="released"),
    trailing_edge=through((0.5, 0.5), (0.42, 0.7), (0.38, 0.95), ends="released"),
)
UNEVEN = replace(
    GIVEN,
    path=replace(
        GIVEN.path,
        stream_surfaces=tuple(through(*points[1:4]) for points in arcs_between(_HUB, _SHROUD, 4)),
        stream_spans=(0.3, 0.7),
        matched="edges",
    ),
)
"""its stream surfaces are shorter than hub and shroud, as those of some of T-Blade3's cases are"""

MACHINES = {
    "cylinder": CYLINDER,
    "cone": CONE,
    "bend": BEND,
    "duct": DUCT,
    "disc": DISC,
    "impeller": IMPELLER,
    "given": GIVEN,
    "uneven": UNEVEN,
}
