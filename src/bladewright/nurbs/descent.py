"""Locally closest points: damped Newton steps on the squared distance, on a curve and from Bezier patch to patch."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from bladewright.nurbs.basis import Reals
from bladewright.nurbs.bezier import Patches, bernstein, bernsteins
from bladewright.nurbs.rational import surface_quotients

MAX_STEPS = 200
"""Newton steps and patches crossed at most: a side has some dozens of thin patches in a row near its edges, and damping
has to find its size where it curves as much as the circle about the query. Of 63 clouds about examples, begun a third
of a patch off, 31 needed more than 20, one 62."""
CONVERGED = 1e-12
"""Step in a patch's parameters, each over [0, 1], after which the next Newton step is below rounding. With 1e-8
distances are 7e-15 chords off (design/nurbs_constants.md)."""
CURVE_STEPS = 60
"""Newton steps on a curve at most; steps that raised the distance and were shortened count too."""
LONGEST_STEP = 2.0
"""Longest Newton step on a curve, in widths of the polynomial piece it starts from. Longer ones leave the piece whose
derivatives predicted them."""
LEAST_GAIN = 1e-17
"""Relative change of a squared distance that a step must predict: less is rounding, which would move a place for ever
where a surface curves as much as the circle about the query. With 0 or 1e-14 distances are the same to rounding
(design/nurbs_constants.md)."""
NOISE = 1e-13
"""Relative rise of a squared distance that counts as rounding, and so does not reject a step. With 0 or 1e-10 distances
are the same to rounding (design/nurbs_constants.md)."""
SINGULAR = 1e-12
"""Determinant of the Hessian, in units of the product of its diagonal, below which the step is that of Gauss and
Newton: less is rounding. With 1e-6 distances are 3e-13 chords off (design/nurbs_constants.md)."""


@dataclass(frozen=True, kw_only=True)
class PatchPoints:
    """Points on patches, one for each of m queries."""

    patch: NDArray[np.intp]
    """(m,) index"""
    local: Reals
    """(m, 2) parameters in [0, 1] of the patch"""
    square: Reals
    """(m,) squared distance to the query"""


def polished(
    on: Patches, queries: Reals, patch: NDArray[np.intp], local: Reals, *, converged: float = CONVERGED
) -> PatchPoints:
    """The local minima of the distance to queries (m, d) at which descents from starts on patches (m,), (m, 2) end.

    `converged` is the last step in local parameters; the distance is accurate to its square.
    """
    if not (on.degrees[1] or on.rational):
        return _polished_on_curve(on, queries, patch, local, converged)
    patch, local = patch.copy(), local.copy()
    nets = on.nets if on.rational else on.nets[..., :-1]
    square, gradient, hessian, metric = _distance_model(nets[patch], queries, local)
    damping, came, active = np.zeros(len(patch)), np.full(len(patch), -1), np.arange(len(patch))
    for _ in range(MAX_STEPS):
        at, slope = local[active], gradient[active]
        trial = np.clip(at + newton_step(slope, hessian[active], metric[active], damping[active], at), 0.0, 1.0)
        gain = np.sum(slope * (trial - at), axis=1)
        moved = (np.max((trial - at) ** 2, axis=1) > converged**2) & (gain**2 > (LEAST_GAIN * square[active]) ** 2)
        # a border outside which it is nearer is crossed: from a corner, no step from inside leads on
        above, below = (at >= 1.0) & (slope < 0.0), (at <= 0.0) & (slope > 0.0)
        onward, exists = on.neighbours(patch[active], above.astype(np.intp) - below)
        cross = exists & (above | below)
        # on a corner either side leads to the other
        going = moved | (np.any(cross, axis=1) & (onward != came[active]))
        active, trial, moved, onward = active[going], trial[going], moved[going], onward[going]
        if len(active) == 0:
            break
        trial = np.where(cross[going], np.where(above[going], 0.0, 1.0), trial)
        new = _distance_model(nets[onward], queries[active], trial)
        better = ~moved | (new[0] <= square[active] * (1.0 + NOISE))
        before = damping[active]
        damping[active] = np.where(better, np.where(before < 1e-3, 0.0, 0.1 * before), np.maximum(10.0 * before, 1e-2))
        came[active] = np.where(moved, -1, patch[active])
        taken = active[better]
        patch[taken], local[taken] = onward[better], trial[better]
        square[taken], gradient[taken], hessian[taken], metric[taken] = (each[better] for each in new)
    return PatchPoints(patch=patch, local=local, square=square)


def _distance_model(nets: Reals, queries: Reals, local: Reals) -> tuple[Reals, Reals, Reals, Reals]:
    """Squared distance (m,), half its gradient (m, 2) and half its Hessian (m, 2, 2), and the metric (m, 2, 2)."""
    along, across = (bernsteins(count - 1, local[:, i]) for i, count in enumerate(nets.shape[1:3]))
    # stacked matrix products: einsum over such small arrays takes ten times as long
    rows = np.matmul(along, nets.reshape(*nets.shape[:2], -1)).reshape(len(nets), 3, *nets.shape[2:])
    orders = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)]
    both = np.matmul(across[:, None], rows)
    of = {(k, l): both[:, k, l] for k, l in orders}  # noqa: E741
    if nets.shape[3] > queries.shape[1]:
        of = surface_quotients(of)
    miss = of[0, 0] - queries
    tangents = np.stack([of[1, 0], of[0, 1]], axis=1)
    second = np.stack([of[2, 0], of[1, 1], of[1, 1], of[0, 2]], axis=1)
    metric = np.matmul(tangents, tangents.transpose(0, 2, 1))
    hessian = metric + np.matmul(second, miss[:, :, None]).reshape(metric.shape)
    return np.sum(miss * miss, axis=1), np.matmul(tangents, miss[:, :, None])[:, :, 0], hessian, metric


def descended(
    derivatives: Callable[[Reals], Sequence[Reals]],
    queries: Reals,
    start: Reals,
    ends: tuple[float, float],
    *,
    converged: float = CONVERGED,
) -> tuple[Reals, Reals]:
    """Parameters (m,) where descents on a curve from a start (m,) end, and squared distances (m,) there.

    `derivatives` gives the curve's points and first and second derivatives (m, d), by parameters over units (m,) that
    it may give too; steps are measured in these. A step that raises the distance is shortened.
    """

    def model(at: Reals, targets: Reals) -> tuple[Reals, Reals, Reals]:
        value, first, second, *widths = derivatives(at)
        width = widths[0] if widths else np.ones(len(at))
        miss = value - targets
        speed = np.einsum("md,md->m", first, first)
        bend = speed + np.einsum("md,md->m", miss, second)
        # where the distance is not convex, the Gauss-Newton second derivative still descends
        bend = np.where(bend > 0.0, bend, np.where(speed > 0.0, speed, 1.0))
        step = np.clip(-np.einsum("md,md->m", miss, first) / bend, -LONGEST_STEP, LONGEST_STEP)
        return np.einsum("md,md->m", miss, miss), step * width, width

    u = np.clip(start, *ends)
    square, step, width = model(u, queries)
    active = np.arange(len(u))
    for _ in range(CURVE_STEPS):
        trial = np.clip(u[active] + step[active], *ends)
        far = (trial - u[active]) ** 2 > (converged * width[active]) ** 2
        active, trial = active[far], trial[far]
        if len(active) == 0:
            break
        new = model(trial, queries[active])
        better = new[0] <= square[active] * (1.0 + NOISE)
        step[active[~better]] *= 0.25
        taken = active[better]
        u[taken], square[taken], step[taken], width[taken] = (each[better] for each in (trial, *new))
    return u, square


def _polished_on_curve(
    on: Patches, queries: Reals, patch: NDArray[np.intp], local: Reals, converged: float
) -> PatchPoints:
    """As `polished` on the polynomials of a curve, in their one parameter; steps pass from piece to piece."""
    degree = on.degrees[0]
    coefficients = np.einsum("ij,kjd->ikd", _powers(degree), on.nets[:, :, 0, :-1])
    low = on.low[:, 0]
    width = on.high[:, 0] - low

    def derivatives(at: Reals) -> tuple[Reals, Reals, Reals, Reals]:
        piece = np.clip(np.searchsorted(low, at, side="right") - 1, 0, len(low) - 1)
        t = ((at - low[piece]) / width[piece])[:, None]
        of = coefficients[:, piece]
        value, first, second = of[degree], np.zeros_like(of[0]), np.zeros_like(of[0])
        for row in of[degree - 1 :: -1] if degree else ():
            second = second * t + first
            first = first * t + value
            value = value * t + row
        return value, first, 2.0 * second, width[piece]

    start = low[patch] + local[:, 0] * width[patch]
    u, square = descended(derivatives, queries, start, (low[0], on.high[-1, 0]), converged=converged)
    patch, local = on.at(u, np.zeros(len(u)))
    return PatchPoints(patch=patch, local=local, square=square)


@cache
def _powers(degree: int) -> Reals:
    """The matrix (degree + 1, degree + 1) from Bernstein coefficients to those of powers."""
    orders = [bernstein(degree, np.zeros(1), order)[0] for order in range(degree + 1)]
    factorials = np.cumprod([1.0, *range(1, degree + 1)])
    return np.asarray(np.stack(orders) / factorials[:, None])


def newton_step(gradient: Reals, hessian: Reals, metric: Reals, damping: Reals, local: Reals) -> Reals:
    """Newton steps (m, 2), or Gauss-Newton steps where the Hessian is not convex, in the parameters free to move."""
    diagonal = metric[:, (0, 1), (0, 1)]
    free = ~(((local <= 0.0) & (gradient >= 0.0)) | ((local >= 1.0) & (gradient <= 0.0))) & (diagonal > 1e-300)
    first, last = free.T
    right = np.where(free, -gradient, 0.0)
    # the entries of both matrices: of a parameter that is fixed the diagonal is one
    exact, tensor = (
        (np.where(first, of[:, 0, 0], 1.0), np.where(first & last, of[:, 0, 1], 0.0), np.where(last, of[:, 1, 1], 1.0))
        for of in (hessian, metric)
    )
    (a, b, c), (p, q, r) = exact, tensor
    floor = 1e-14 * np.sum(diagonal, axis=1)
    p, r = p + floor, r + floor
    convex = (a > 0.0) & (c > 0.0) & (a * c - b**2 > SINGULAR * a * c)
    a, b, c = np.where(convex, a, p) + damping * p, np.where(convex, b, q), np.where(convex, c, r) + damping * r
    size = a * c - b * b
    size = np.where(size > 0.0, size, 1.0)
    return np.stack([c * right[:, 0] - b * right[:, 1], a * right[:, 1] - b * right[:, 0]], axis=1) / size[:, None]
