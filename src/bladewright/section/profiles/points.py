"""Profiles through any closed set of points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from bladewright.designs import ChordwiseLaw, parameter
from bladewright.errors import DesignError
from bladewright.numerics.elementary import dot
from bladewright.section import checks
from bladewright.section.laws import Span
from bladewright.section.profiles.points_outline import PointsOutline, contour
from bladewright.section.profiles.profile import Profile
from bladewright.section.profiles.quintic_spline import DEGREE

MIN_POINTS = 8
"""fewest points of a contour: six for a quintic spline, and two more to distinguish its edges from its sides"""


@dataclass(frozen=True, kw_only=True)
class PointsProfile(Profile):
    """A profile through points: a closed contour in order, from any point, in either sense, of any size and direction.

    A spline of degree 5 with four continuous derivatives runs through the points, at centripetal parameters (Lee 1989);
    it is broken at sharp edges (one corner) and blunt ones (two). A corner is a point where the polygon turns by 30 deg
    or more, ten times as much as beside it; so do the two of a blunt edge together. A round edge is the point of the
    spline farthest from the other edge. The chord line is brought to (0, 0)-(1, 0), the leading edge being the end with
    the smaller abscissa. The camber line is the polynomial of degree 8 that is nearest to the middle between the sides,
    away from the edges.
    """

    kind: Literal["points"] = "points"
    """which kind of profile this is"""
    abscissas: ChordwiseLaw = parameter("-")
    """of the points along the contour [-]"""
    ordinates: ChordwiseLaw = parameter("-")
    """of the points along the contour [-]"""

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("abscissas", "ordinates"):
            object.__setattr__(self, name, checks.chordwise(name, getattr(self, name)))
        if len(self.abscissas) != len(self.ordinates):
            raise DesignError(
                f"abscissas has {len(self.abscissas)} entries and ordinates {len(self.ordinates)}: give each point both"
            )
        if len(self.abscissas) < MIN_POINTS:
            raise DesignError(
                f"abscissas has {len(self.abscissas)} entries: a contour needs at least {MIN_POINTS} points"
            )

    def control_places(self, row: str) -> Sequence[float] | None:  # noqa: ARG002 - both rows are the contour's
        """The points run around the contour."""
        return ()

    def outline(self, span: Span) -> PointsOutline:
        """The exact sections (..., m) at the places of the span, in chords, unstaggered."""
        axes = [span.control_values(laws) for laws in (self.abscissas, self.ordinates)]
        points = np.stack(np.broadcast_arrays(*axes), axis=-1)
        first = np.real(points).reshape(-1, *points.shape[-2:])[0]
        if np.all(first[0] == first[-1]):
            points, first = points[..., :-1, :], first[:-1]
        steps = np.roll(first, -1, axis=0) - first
        still = np.flatnonzero(dot(steps, steps) == 0.0)
        if len(still):
            raise DesignError(f"abscissas[{still[0]}] and ordinates[{still[0]}]: the point is given twice; drop one")
        shape = contour(first)
        if "round" not in shape.kinds:
            closing = 1 if shape.kinds[1] == "sharp" else 0
            sides = {"upper": shape.leading[0] + 1, "lower": len(first) + closing - shape.leading[-1]}
            for name, count in sides.items():
                if count <= DEGREE:
                    raise DesignError(
                        f"abscissas has {count} points on the {name} side, between the corners of its edges: at least "
                        f"{DEGREE + 1} are needed"
                    )
        return PointsOutline(given=points[..., shape.order, :], contour=shape)
