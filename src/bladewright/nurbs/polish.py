"""Damped Newton iteration to a nearest point, from patch to patch, for many points at once."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bladewright.nurbs.basis import Reals
from bladewright.nurbs.bezier import Patches, bernsteins
from bladewright.nurbs.rational import surface_quotients

ROUNDS, STEPS = 80, 40
"""patches a point may cross, and Newton steps in each"""
CONVERGED = 1e-12
"""step in local parameters after which Newton's next one is below rounding"""
NOISE = 1e-13
"""relative rise of a squared distance that is rounding"""


@dataclass(frozen=True, kw_only=True)
class Places:
    """Points on patches: one for each of m queries."""

    patch: NDArray[np.intp]
    """(m,) index"""
    local: Reals
    """(m, 2) parameters in [0, 1] of the patch"""
    square: Reals
    """(m,) squared distance to the query"""


def polished(
    on: Patches, queries: Reals, patch: NDArray[np.intp], local: Reals, *, converged: float = CONVERGED
) -> Places:
    """Where descent from a start on a patch (m,), (m, 2) ends: a local minimum of the distance to queries (m, d).

    `converged` is a last step in local parameters; the distance is exact to its square.
    """
    patch, local = patch.copy(), local.copy()
    nets = on.nets if on.rational else on.nets[..., :-1]
    square = np.full(len(patch), np.inf)
    moving = np.arange(len(patch))
    for _ in range(ROUNDS):
        local[moving], square[moving], out = _descended(nets[patch[moving]], queries[moving], local[moving], converged)
        onward, exists = on.neighbours(patch[moving], out)
        cross = exists & (out != 0)
        moved = cross.any(axis=1)
        moving, onward, cross, out = moving[moved], onward[moved], cross[moved], out[moved]
        if len(moving) == 0:
            break
        patch[moving] = onward
        local[moving] = np.where(cross, np.where(out > 0, 0.0, 1.0), local[moving])
    return Places(patch=patch, local=local, square=square)


def _descended(nets: Reals, queries: Reals, local: Reals, converged: float) -> tuple[Reals, Reals, NDArray[np.intp]]:
    """Local parameters (m, 2) and squared distance after descent in each patch, and which way it would leave it."""
    local = local.copy()
    square, gradient, hessian, metric = _model(nets, queries, local)
    damping = np.zeros(len(local))
    active = np.arange(len(local))
    for _ in range(STEPS):
        step = _step(gradient[active], hessian[active], metric[active], damping[active], local[active])
        trial = np.clip(local[active] + step, 0.0, 1.0)
        far = np.max((trial - local[active]) ** 2, axis=1) > converged**2
        active, trial = active[far], trial[far]
        if len(active) == 0:
            break
        new = _model(nets[active], queries[active], trial)
        better = new[0] <= square[active] * (1.0 + NOISE)
        damping[active] = np.where(
            better, np.where(damping[active] < 1e-3, 0.0, 0.1 * damping[active]), 0.0
        ) + np.where(better, 0.0, np.maximum(10.0 * damping[active], 1e-2))
        taken = active[better]
        local[taken], square[taken] = trial[better], new[0][better]
        gradient[taken], hessian[taken], metric[taken] = new[1][better], new[2][better], new[3][better]
    outward = np.where((local >= 1.0) & (gradient < 0.0), 1, np.where((local <= 0.0) & (gradient > 0.0), -1, 0))
    return local, square, outward


def _model(nets: Reals, queries: Reals, local: Reals) -> tuple[Reals, Reals, Reals, Reals]:
    """Squared distance (m,), half its gradient (m, 2) and Hessian (m, 2, 2), and the metric tensor (m, 2, 2)."""
    along, across = (bernsteins(count - 1, local[:, i]) for i, count in enumerate(nets.shape[1:3]))
    # stacked products: sums over the products of small arrays take ten times as long
    rows = np.matmul(along, nets.reshape(*nets.shape[:2], -1)).reshape(len(nets), 3, *nets.shape[2:])
    orders = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)]
    both = np.matmul(across[:, None], rows)
    of = {(k, l): both[:, k, l] for k, l in orders}  # noqa: E741
    if nets.shape[3] > queries.shape[1]:
        of = surface_quotients(of)
    miss = of[0, 0] - queries
    tangents = np.stack([of[1, 0], of[0, 1]], axis=1)
    second = np.stack([of[2, 0], of[1, 1], of[1, 1], of[0, 2]], axis=1).reshape(len(miss), 2, 2, -1)
    metric = np.einsum("mad,mbd->mab", tangents, tangents)
    hessian = metric + np.einsum("mabd,md->mab", second, miss)
    return np.sum(miss * miss, axis=1), np.einsum("mad,md->ma", tangents, miss), hessian, metric


def _step(gradient: Reals, hessian: Reals, metric: Reals, damping: Reals, local: Reals) -> Reals:
    """Newton's step, or Gauss and Newton's where that does not descend, in the directions that are free to move."""
    held = ((local <= 0.0) & (gradient >= 0.0)) | ((local >= 1.0) & (gradient <= 0.0))
    held |= np.einsum("maa->ma", metric) <= 1e-300
    free = ~held
    both = free[:, :, None] & free[:, None, :]
    floor = 1e-14 * np.einsum("maa->m", metric)[:, None]
    eye = np.eye(2, dtype=bool)
    tensor = np.where(both, metric, 0.0) + np.where(eye, np.where(free, floor, 1.0)[:, :, None], 0.0)
    exact = np.where(both, hessian, 0.0) + np.where(eye, np.where(free, 0.0, 1.0)[:, :, None], 0.0)
    convex = (exact[:, 0, 0] > 0.0) & (exact[:, 1, 1] > 0.0)
    determinant = exact[:, 0, 0] * exact[:, 1, 1] - exact[:, 0, 1] ** 2
    convex &= determinant > 1e-12 * exact[:, 0, 0] * exact[:, 1, 1]
    matrix = np.where(convex[:, None, None], exact, tensor)
    matrix = matrix + np.where(eye, damping[:, None, None] * tensor, 0.0)
    a, b, c = matrix[:, 0, 0], matrix[:, 0, 1], matrix[:, 1, 1]
    right = np.where(free, -gradient, 0.0)
    size = a * c - b * b
    size = np.where(size > 0.0, size, 1.0)
    return np.stack([c * right[:, 0] - b * right[:, 1], a * right[:, 1] - b * right[:, 0]], axis=1) / size[:, None]
