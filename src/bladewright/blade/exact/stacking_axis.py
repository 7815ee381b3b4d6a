"""Stacking without edge curves: the sections' reference points, and where they stand in the flow path."""

from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np

from bladewright.blade.design.stacking import HUB_PLACES, Stacking
from bladewright.blade.exact.orthogonal_trajectory import OrthogonalTrajectory, orthogonal_trajectory
from bladewright.blade.flow_path.blade_streamlines import blade_streamlines, labels
from bladewright.blade.flow_path.intersections import Intersection, intersections
from bladewright.blade.flow_path.meridional_curve import MeridionalCurve, real_first, spline_on
from bladewright.blade.flow_path.stream_surface_map import Cascade
from bladewright.blade.flow_path.stream_surfaces import StreamSurfaces
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, concatenated
from bladewright.numerics.quadrature import converged_quadrature, gauss, panels
from bladewright.nurbs.basis import Reals
from bladewright.section.laws import Span
from bladewright.section.outline import Outline

PIECES = 6
"""pieces in equal steps that a side is cut into besides its joints"""


def reference_points(stacking: Stacking | None, outline: Outline, span: Span) -> Array:
    """Points (..., m, 2) of the sections in chords, unstaggered; the leading edge where there is no stacking."""
    which = "leading-edge" if stacking is None else stacking.reference
    if which == "centroid":
        return centroid(outline)
    ends = {"leading-edge": 0.0, "trailing-edge": 1.0}
    along = np.full(len(span.v), ends[which]) if which in ends else _fraction(stacking, span)
    return np.stack([along, np.zeros_like(along)], axis=-1)


def _fraction(stacking: Stacking | None, span: Span) -> Array:
    law = None if stacking is None else stacking.chord_fraction
    return span.values(0.0 if law is None else law)


def centroid(outline: Outline) -> Array:
    """Centres of area (..., 2) of sections in their planes, in chords, by Green's theorem and Gauss quadrature.

    Each side is the polynomial through the Gauss points of a panel, whose order is raised until the centre moves by
    less than 1e-13.
    """
    return converged_quadrature(lambda order: _centroid(outline, order))


def _centroid(outline: Outline, order: int) -> Array:
    breaks = np.unique([*np.linspace(0.0, 1.0, PIECES + 1), *(joint.s for joint in outline.joints)])
    s, weights = panels(breaks, order)
    slopes = _slopes(order)
    widths = np.diff(breaks)[:, None, None]
    upper, lower = outline.points(s)
    area: Array = np.zeros(())
    first: Array = np.zeros(())
    second: Array = np.zeros(())
    for side, sign in ((upper, 1.0), (lower, -1.0)):
        pieces = side.reshape(*side.shape[:-2], len(breaks) - 1, order, 2)
        rates = ((slopes @ pieces) / widths).reshape(side.shape)
        x, y = side[..., 0], side[..., 1]
        area = area + sign * np.sum(weights * (x * rates[..., 1] - y * rates[..., 0]), axis=-1) / 2.0
        first = first + sign * np.sum(weights * x**2 * rates[..., 1], axis=-1) / 2.0
        second = second - sign * np.sum(weights * y**2 * rates[..., 0], axis=-1) / 2.0
    for start, end in _faces(outline):
        a, b = np.moveaxis(start, -1, 0), np.moveaxis(end, -1, 0)
        step = b - a
        area = area + (a[0] * b[1] - a[1] * b[0]) / 2.0
        first = first + step[1] * (a[0] ** 2 + a[0] * b[0] + b[0] ** 2) / 6.0
        second = second - step[0] * (a[1] ** 2 + a[1] * b[1] + b[1] ** 2) / 6.0
    return concatenated([(first / area)[..., None], (second / area)[..., None]], axis=-1)


def _faces(outline: Outline) -> list[tuple[Array, Array]]:
    """Ends (..., 2) of the straight faces of blunt edges, round the section as the upper side runs."""
    first, last = outline.leading_edge, outline.trailing_edge
    found = [(last.upper.point, last.lower.point)] if last.kind == "blunt" else []
    return found + ([(first.lower.point, first.upper.point)] if first.kind == "blunt" else [])


def _slopes(order: int) -> Reals:
    """Derivatives (order, order) at Gauss points of [0, 1] of the polynomial through values there, barycentric."""
    nodes = gauss(order)[0]
    apart = nodes[:, None] - nodes + np.eye(order)
    shares = 1.0 / np.prod(4.0 * apart, axis=1)
    matrix = shares / shares[:, None] / apart
    np.fill_diagonal(matrix, 0.0)
    np.fill_diagonal(matrix, -np.sum(matrix, axis=1))
    return matrix


WIDER = 0.1
"""share of the flow path by which a line of equal x or r reaches past it"""


@dataclass(frozen=True, kw_only=True, eq=False)
class StackingAxis:
    """The reference points of a stacking without edge curves, in a flow path."""

    surfaces: StreamSurfaces
    stacking: Stacking
    metre: float
    """metres in the design's unit of length"""

    def t(self, v: Reals) -> Array:
        """t (..., m) of the reference points at v (m,); raises DesignError where there is none, or more than one."""
        return self.path.t(v) if self.stacking.onwards == "least-distance" else self.meeting(v).t

    def meeting(self, v: Reals) -> Intersection:
        """Where the stream lines at v (m,) meet the stacking line."""
        name = "stacking.line" if self.stacking.line is not None else f"stacking.{self.given}"
        try:
            return intersections(partial(self.surfaces.position, v), self.surfaces.extent, self.line, name, labels(v))
        except DesignError as error:
            if not self.stacking.from_hub:
                raise
            raise DesignError(
                f"{error}; or take stacking.onwards = 'least-distance', for which the stream lines need not have one "
                f"{self.stacking.onwards[-1]} in common"
            ) from error

    @property
    def given(self) -> str:
        """The name of the hub's place."""
        return next(name for name in HUB_PLACES if getattr(self.stacking, name) is not None)

    @cached_property
    def line(self) -> MeridionalCurve:
        """The stacking line in (x, r), straight where it follows from the hub's point."""
        if self.stacking.line is not None:
            return self.stacking.line.line(self.metre)
        if (self.given, self.stacking.onwards) in (("hub_x", "equal-x"), ("hub_r", "equal-r")):
            return self._straight(self.given[-1], self._value)
        point = self.surfaces.position(np.zeros(1), real_first(self.hub, 0).reshape(1, 1))[..., 0, 0, :]
        slope = self.surfaces.position(np.zeros(1), real_first(self.hub, 0).reshape(1, 1), 1)[..., 0, 0, :]
        axis = "x" if self.stacking.onwards == "equal-x" else "r"
        which = "xr".index(axis)
        carried = self.hub - real_first(self.hub, 0)
        return self._straight(axis, point[..., which] + carried * slope[..., which])

    @cached_property
    def path(self) -> OrthogonalTrajectory:
        """The line of least distance through the hub's point."""
        return orthogonal_trajectory(self.surfaces, self.hub)

    @cached_property
    def hub(self) -> Array:
        """t (...) of the hub's reference point."""
        at = np.zeros(1)
        if self.given == "hub_m":
            return self._by_length(at)
        line = self._straight(self.given[-1], self._value)
        position = partial(self.surfaces.position, at)
        return intersections(position, self.surfaces.extent, line, f"stacking.{self.given}", ["of the hub"]).t[..., 0]

    @property
    def _value(self) -> Array:
        return np.asarray(self.metre * getattr(self.stacking, self.given))

    def _by_length(self, at: Reals) -> Array:
        low, high = self.surfaces.extent
        whole = blade_streamlines(
            self.surfaces, at, Cascade(), np.array([low]), np.array([high]), before=0.0, after=0.0
        )
        asked, there = float(real_first(self._value, 0)), float(real_first(whole.lengths, 1)[0])
        if not 0.0 < asked < there:
            raise DesignError(
                f"stacking.hub_m is {asked / self.metre:g}: the hub is {there / self.metre:.6g} long from its start to "
                "its end, and the reference point must lie between; give a place on the hub, or lengthen it"
            )
        return whole.t(whole.u_at(self._value[..., None, None]))[..., 0, 0]

    def _straight(self, axis: str, value: Array) -> MeridionalCurve:
        """The line of one x, or one r, through the whole flow path."""
        real = self.surfaces.real()
        grid = real.grid(np.linspace(*real.extent, 33), np.linspace(0.0, 1.0, 17))[0].reshape(-1, 2)
        other = grid[:, 1 if axis == "x" else 0]
        room = WIDER * (float(np.max(other)) - float(np.min(other)))
        across = np.array([np.min(other) - room, np.max(other) + room])
        held = value[..., None] * np.ones(2)
        pair = (held, np.broadcast_to(across, held.shape))
        return spline_on(np.stack(pair if axis == "x" else pair[::-1], axis=-1), 1)
