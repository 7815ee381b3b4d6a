"""Caps of a blade that stands past its walls: untrimmed faces within the ends of its sides and of its blunt edges."""

from collections.abc import Mapping

import numpy as np

from bladewright.numerics.elementary import Array, joined
from bladewright.nurbs.basis import Reals, greville
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.domain import piece, reparametrised
from bladewright.nurbs.domain import reversed as run_back
from bladewright.nurbs.refine import inserted
from bladewright.nurbs.surface import Surface

EDGES = ("leading_edge", "trailing_edge")


def cap(upper: Surface, lower: Surface, faces: Mapping[str, Surface], back: float | None, row: int) -> Surface:
    """The cap of the end at v = 0 (row 0) or v = 1 (row -1): v runs from the lower to the upper side's end.

    It has the control points of its neighbours' ends: ruled where the sides meet at both edges, and else Coons's
    bilinear patch. `faces` are those of blunt edges; `back` is the u from which both sides are one straight back face,
    across which the cap ends. Coons 1967; Farin 2002, Curves and Surfaces for CAGD, section 22.2.
    """
    low, high = (_end(side, row) for side in (lower, upper))
    across = {name: run_back(_end(face, row)) for name, face in faces.items()}
    if back is not None:
        across["trailing_edge"] = _end_to_end(piece(low, back, 1.0), run_back(piece(high, back, 1.0)))
        low, high = (reparametrised(piece(end, 0.0, back)) for end in (low, high))
    net = np.stack([low.control_points, high.control_points], axis=-2)
    if not across:
        return Surface(
            control_points=net,
            knots_u=low.knots,
            knots_v=np.array([0.0, 0.0, 1.0, 1.0]),
            degree_u=low.degree,
            degree_v=1,
        )
    pattern = across["trailing_edge"] if "trailing_edge" in across else across["leading_edge"]
    return Surface(
        control_points=_coons(net, across, _shares(low), _shares(pattern)),
        knots_u=low.knots,
        knots_v=pattern.knots,
        degree_u=low.degree,
        degree_v=pattern.degree,
    )


def parted(side: Surface, back: float | None) -> Surface:
    """The side with full knots where a back face begins, its shape unchanged, so that it has two ends at each wall."""
    if back is None:
        return side
    missing = side.degree_u - int(np.sum(side.knots_u == back))
    return inserted(side, np.full(missing, back), "u") if missing else side


def _coons(net: Array, across: Mapping[str, Curve], u: Reals, v: Reals) -> Array:
    """The net within the ends of both sides (n, 2, 3) and the curves `across`, straight where there is none.

    A linear function has its values at the Greville abscissae u (n,) and v (m,) for control points.
    """
    ruled = net[:, :1] + v[:, None] * (net[:, 1:] - net[:, :1])
    for edge, at, share in zip(EDGES, (0, -1), (1.0 - u, u), strict=True):
        if edge in across:
            ruled = ruled + share[:, None, None] * (across[edge].control_points - ruled[at])
    return joined([net[:, :1], ruled[:, 1:-1], net[:, 1:]], axis=1)


def _end_to_end(first: Curve, second: Curve) -> Curve:
    """Two curves over [0, 1], the first up to 1/2, where the second begins."""
    parts = reparametrised(first, 0.0, 0.5), reparametrised(second, 0.5, 1.0)
    return Curve(
        control_points=joined([parts[0].control_points, parts[1].control_points[1:]], axis=0),
        knots=np.concatenate([parts[0].knots[:-1], parts[1].knots[first.degree + 1 :]]),
        degree=first.degree,
    )


def _end(face: Surface, row: int) -> Curve:
    return Curve(control_points=face.control_points[:, row], knots=face.knots_u, degree=face.degree_u)


def _shares(curve: Curve) -> Reals:
    return greville(curve.knots, curve.degree)
