"""Ruled blades: straight lines in space between the hub's and the shroud's section, point by point."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from bladewright.blade.exact.family_sections import FamilySections, FlowPathSections
from bladewright.blade.flow_path.meridional_curve import real_first
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, cross, dot, length
from bladewright.nurbs.basis import Reals
from bladewright.section.outline import EdgeDerivatives

ENDS = np.array([0.0, 1.0])
CHECKED = np.linspace(0.0, 1.0, 41)
"""Parameters along the sides at which the upper side must stay on its side of the lower one."""


@dataclass(frozen=True, kw_only=True, eq=False)
class RuledSections(FlowPathSections):
    """Curves of constant v (m,) of a ruled blade: the design's sections at hub and shroud, mixed as 1 - v to v.

    A line joins points of equal s of the same side, and native sides are linear along v, so that their lines are
    straight to rounding. What is given up: between the ends the curves are not the design's sections, and lie on no
    stream surface; there `lines`, plane points and camber are those of the sections that the design has at v,
    which are nearby. Voss et al. 2025, section 5; the ruled impeller of the freeform method, its section 3.3.
    """

    rails: FamilySections
    """the sections at hub and shroud"""
    beside: FamilySections
    """the sections at v"""

    def plane_points(self, s: Reals) -> tuple[Array, Array]:
        return self.beside.plane_points(s)

    @property
    def skinning(self) -> Literal["sections", "ruled", "developable"]:
        return "ruled"

    @property
    def edge_kinds(self) -> tuple[str, str]:
        return self.rails.edge_kinds

    @property
    def back(self) -> float | None:
        return self.rails.back

    def camber(self, share: Reals) -> Array:
        return self.beside.camber(share)

    def chord_line(self, u: Array, order: int = 0) -> Array:
        """That of straight lines between the chord lines of hub and shroud, whose ends are the blade's own edges."""
        u = np.broadcast_to(u, (len(self.v), np.shape(u)[-1]))
        rails = self.rails.chord_lines_in_space(np.reshape(u, -1))
        shares = self._shares[:, :, None, None]
        point, first = (
            np.einsum("mjkd->mkd", shares * np.swapaxes(each.reshape(2, *u.shape, 3), 0, 1)) for each in rails
        )
        if not self.mapping.revolved:
            return np.asarray((point, first)[order][..., [0, 2]])
        r = length(point[..., 1:])
        return np.stack(
            [(point, first)[order][..., 0], r if order == 0 else dot(point[..., 1:], first[..., 1:]) / r], -1
        )

    def camber_ends(self) -> tuple[Array, Array]:
        return self.beside.camber_ends()

    def outlines(self) -> Reals:
        return self.beside.outlines()

    def leading_edge(self) -> EdgeDerivatives:
        return self._mixed_row(self.rails.leading_edge())

    def trailing_edge(self) -> EdgeDerivatives:
        return self._mixed_row(self.rails.trailing_edge())

    def lower_edges(self) -> tuple[EdgeDerivatives | None, EdgeDerivatives | None]:
        first, last = (None if row is None else self._mixed_row(row) for row in self.rails.lower_edges())
        return first, last

    def faces(self, w: Reals) -> dict[str, Array]:
        return {name: self._mixed(points) for name, points in self.rails.faces(w).items()}

    def points(self, s: Reals) -> tuple[Array, Array]:
        upper, lower = (self._mixed(side) for side in self.rails.points(s))
        return upper, lower

    def points_and_normals(self, s: Reals) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
        """Points, and the unit normals of hub and shroud at the ends; zero between, where there is no such surface."""
        at_ends = ((self.v == 0.0) | (self.v == 1.0)).astype(float)[:, None, None]
        _, normals = self.rails.points_and_normals(s)
        upper, lower = (self._mixed(each) * at_ends for each in normals)
        return self.points(s), (upper, lower)

    def check(self) -> None:
        """Refuse a ruled blade that is turned inside out: whose sides change places between hub and shroud.

        By the sign of their distance across the surface midway between them.
        """
        upper, lower = (real_first(side, 3) for side in self.points(CHECKED))
        middle = (upper + lower) / 2.0
        along = np.gradient(middle, CHECKED, axis=1)
        across = middle[-1] - middle[0]
        sizes = dot(upper - lower, cross(along, np.broadcast_to(across, along.shape)))[:, 1:-1]
        wrong = np.argwhere(sizes * sizes[:1] <= 0.0)
        if len(wrong):
            row, at = wrong[0]
            raise DesignError(
                f"skinning is 'ruled', and the straight lines between hub and shroud turn the blade inside out: its "
                f"sides change places at v = {self.v[row]:.3f}, s = {CHECKED[at + 1]:.3f} (0 is the leading, 1 the "
                "trailing edge), for the sections at hub and shroud are turned too far against each other; bring their "
                "stagger and camber nearer to each other, make them thicker, or take skinning = 'sections'"
            )

    def _mixed_row(self, row: EdgeDerivatives) -> EdgeDerivatives:
        shares = self._shares
        return EdgeDerivatives(*(np.asarray(np.einsum("mj,...jd->...md", shares, part)) for part in row))

    def _mixed(self, points: Array) -> Array:
        return np.asarray(np.einsum("mj,...jkd->...mkd", self._shares, points))

    @property
    def _shares(self) -> Reals:
        return np.stack([1.0 - self.v, self.v], axis=-1)


def ruled_sections(rails: FamilySections, beside: FamilySections) -> RuledSections:
    """The ruled blade between the sections at hub and shroud, at the places v of the sections beside."""
    return RuledSections(v=beside.v, lines=beside.lines, rails=rails, beside=beside)
