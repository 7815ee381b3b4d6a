"""Curves made compatible (one degree, one knot vector), and curves joined end to end."""

from collections.abc import Sequence

import numpy as np

from bladewright.errors import GeometryError
from bladewright.numerics.elementary import Array, length
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.blossom import knot_change
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.domain import reparametrised
from bladewright.nurbs.refine import changed_along, elevated

SAME_KNOT = 1e-12
"""Distance, in units of the domain, below which knots of two curves are one knot: it is a few thousand roundings."""
SAME_POINT = 1e-9
"""Gap, in units of the extent of the curves, below which two ends meet: 1e-7 mm on a blade of 100 mm."""


def compatible(curves: Sequence[Curve]) -> tuple[Curve, ...]:
    """The same curves over [0, 1] with one degree and one knot vector in common, all weighted or none.

    Raises GeometryError where there is none, or their dimensions differ.
    """
    degree = _common_degree(curves)
    lifted = [elevated(reparametrised(curve), degree - curve.degree) for curve in curves]
    if any(curve.weights is not None for curve in lifted):
        lifted = [weighted(curve) for curve in lifted]
    values = np.unique(np.concatenate([curve.knots for curve in lifted]))
    values = values[np.concatenate([[True], np.diff(values) > SAME_KNOT])]
    values[-1] = 1.0
    snapped = [values[np.argmin((curve.knots[:, None] - values) ** 2, axis=1)] for curve in lifted]
    knots = np.repeat(values, np.max([np.sum(own[:, None] == values, axis=0) for own in snapped], axis=0))
    return tuple(
        changed_along(curve, "u", knot_change(own, degree, knots), knots, degree)
        for curve, own in zip(lifted, snapped, strict=True)
    )


def joined(curves: Sequence[Curve]) -> Curve:
    """One curve that runs through the given ones in order, each starting where the last one ends.

    Its domain starts at 0 and each piece keeps the length of its own; the pieces meet at knots of multiplicity
    `degree`, at the mean of the two ends. Weights are scaled so that they agree where pieces meet. Raises GeometryError
    where two ends are further apart than 1e-9 of the extent, or where dimensions differ.
    """
    degree = _common_degree(curves)
    lifted = [elevated(curve, degree - curve.degree) for curve in curves]
    rational = any(curve.weights is not None for curve in lifted)
    points = np.concatenate([curve.control_points for curve in lifted])
    extent = float(np.ptp(points.real, axis=0).max())
    knots: list[Reals] = [np.zeros(degree + 1)]
    coordinates: list[Array] = []
    weights: list[Array] = []
    for index, curve in enumerate(lifted):
        net = curve.control_points
        weight = np.ones(len(net)) if curve.weights is None else curve.weights
        if index:
            gap = float(length((net[0] - coordinates[-1][-1]).real))
            if gap > SAME_POINT * extent:
                raise GeometryError(
                    f"curve {index} starts {gap:g} away from the end of curve {index - 1}: at most "
                    f"{SAME_POINT * extent:g} can be joined; reverse, reorder or move the curves"
                )
            weight = weight * (weights[-1][-1] / weight[0])
            coordinates[-1] = np.concatenate([coordinates[-1][:-1], 0.5 * (coordinates[-1][-1:] + net[:1])])
        coordinates.append(net[1:] if index else net)
        weights.append(weight[1:] if index else weight)
        shifted = curve.knots[degree + 1 :] - curve.knots[0] + knots[-1][-1]
        knots.append(shifted if index == len(lifted) - 1 else shifted[:-1])
    return Curve(
        control_points=np.concatenate(coordinates),
        knots=np.concatenate(knots),
        degree=degree,
        weights=np.concatenate(weights) if rational else None,
    )


def weighted(curve: Curve) -> Curve:
    """The same curve as a rational one: with weights of one where it had none."""
    if curve.weights is not None:
        return curve
    ones = np.ones(len(curve.control_points))
    return Curve(control_points=curve.control_points, knots=curve.knots, degree=curve.degree, weights=ones)


def _common_degree(curves: Sequence[Curve]) -> int:
    shapes = {curve.control_points.shape[1:] for curve in curves}
    if len(shapes) != 1:
        raise GeometryError(
            f"{len(curves)} curves with control points of shapes {sorted(shapes)} were to be put together: "
            "give at least one, all of one dimension"
        )
    return max(curve.degree for curve in curves)
