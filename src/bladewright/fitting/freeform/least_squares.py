"""Least squares of distances in a scaled trust region, for many points and few unknowns.

A sum of penalties of distances, `sum w rho(d^2)`, is handed on as its value, half its gradient and half its curvature
without the second derivatives of the distances. These three are all that a trust region of Gauss and Newton sees of a
problem, so scipy's solver gets the smallest problem that has them: one row for each unknown and one for what is left.
The number of points then costs only evaluations.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.sparse import csr_array

from bladewright.nurbs.basis import Reals

DENSE_UNKNOWNS = 400
"""unknowns up to which full products of rows are taken for faster than sparse ones."""
BLOCK_ROWS = 8192
"""rows in a full product; it bounds the memory."""
LOST_EIGENVALUE = 1e-14
"""eigenvalue of the scaled curvature, of the largest, below which its direction is rounding."""
SETTLED_SHARE = 0.02
"""share of the value that the quadratic at the end would remove, up to which a descent has converged. Where control
points slide along the shape the value falls little for hundreds of steps."""
DETERMINED_EIGENVALUE = 1e-12
"""eigenvalue of the scaled curvature, of the largest, above which the points determine its direction."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Quadratic:
    """An objective near some unknowns x (n,): `value + 2 gradient . step + step . curvature . step`."""

    value: float
    gradient: Reals
    """(n,) half of it"""
    curvature: Reals
    """(n, n) half of it, never negative"""

    def __add__(self, other: "Quadratic") -> "Quadratic":
        return Quadratic(
            value=self.value + other.value,
            gradient=self.gradient + other.gradient,
            curvature=self.curvature + other.curvature,
        )


@dataclass(frozen=True, kw_only=True)
class Penalty:
    """Cost of a distance: `d^power`."""

    power: float = 2.0
    scale: float = 1.0
    """distance that costs 1 (powers above 2 would vanish in rounding without it)"""

    def __call__(self, distances: Reals) -> tuple[Reals, Reals, Reals]:
        """Cost rho (m,), its slope drho/dz (m,) by z = d^2, and its curvature along and across the distance over it."""
        share = (distances / self.scale) ** (self.power - 2.0) if self.power != 2.0 else np.ones_like(distances)
        slope = 0.5 * self.power * share
        return distances**2 * share, slope, np.full_like(distances, self.power - 1.0)


@dataclass(frozen=True, kw_only=True, eq=False)
class Minimum:
    """Where the descent ended."""

    x: Reals
    evaluations: int
    converged: bool


def quadratic_of_distances(
    along: csr_array,
    distances: Reals,
    across: csr_array,
    across_of: NDArray[np.intp],
    penalty: Penalty,
    weights: Reals,
) -> Quadratic:
    """The objective of distances (m,) whose derivatives by n unknowns are `along` (m, n).

    `across` (k, n) are derivatives of misses that are zero now, perpendicular to the distance, of the points
    `across_of` (k,): they bend the objective where they do not slope it. `weights` (m,) multiply the costs.
    """
    cost, slope, stretch = penalty(distances)
    slope = slope * weights
    gradient = np.asarray(along.T @ (slope * distances))
    curvature = _gram(along, slope * stretch) + _gram(across, slope[across_of])
    return Quadratic(value=float(np.sum(weights * cost)), gradient=gradient, curvature=curvature)


def minimised(
    objective: Callable[[Reals], Quadratic],
    start: Reals,
    *,
    accepted: Callable[[], None] | None = None,
    evaluations: int = 200,
    tolerance: float = 1e-13,
) -> Minimum:
    """The unknowns (n,) at which the objective is least near the start.

    `accepted` is called when the unknowns asked for last become the current ones. `tolerance` bounds the relative step
    and the relative fall of the value at the end.
    """
    last: dict[bytes, tuple[Quadratic, Reals, Reals]] = {}

    def compressed(x: Reals) -> tuple[Quadratic, Reals, Reals]:
        key = x.tobytes()
        if key not in last:
            found = objective(x)
            last.clear()
            last[key] = (found, *_compressed(found))
        return last[key]

    def slopes(x: Reals) -> Reals:
        found = compressed(x)[2]
        if accepted is not None:
            accepted()
        return found

    if len(start) == 0:
        return Minimum(x=start, evaluations=1, converged=True)
    found = least_squares(
        lambda x: compressed(x)[1],
        start,
        jac=slopes,
        x_scale="jac",
        method="trf",
        ftol=tolerance,
        xtol=tolerance,
        gtol=1e-15,
        max_nfev=evaluations,
    )
    quadratic, residuals, _ = compressed(found.x)
    # the last residual is the value's part that no step of the quadratic takes away
    left = quadratic.value - float(residuals[-1]) ** 2
    return Minimum(
        x=found.x,
        evaluations=int(found.nfev),
        converged=bool(found.status > 0) or left <= SETTLED_SHARE * quadratic.value,
    )


def singular_values(curvature: Reals) -> Reals:
    """Singular values of the rows behind a curvature (n, n), each column scaled to length one; largest first."""
    size = np.sqrt(np.diagonal(curvature))
    scaled = curvature / np.where(size > 0.0, size, 1.0) / np.where(size > 0.0, size, 1.0)[:, None]
    return np.sqrt(np.maximum(np.linalg.eigvalsh(scaled)[::-1], 0.0))


def rank_of(values: Reals) -> int:
    """How many singular values are above what rounding leaves of a zero."""
    return int(np.sum(values > np.sqrt(DETERMINED_EIGENVALUE) * values.max(initial=0.0)))


def _compressed(of: Quadratic) -> tuple[Reals, Reals]:
    """CloudResiduals (n + 1,) and their derivatives (n + 1, n) that have this value, gradient and curvature."""
    size = np.sqrt(np.diagonal(of.curvature))
    size = np.where(size > 0.0, size, 1.0)
    eigenvalues, vectors = np.linalg.eigh(of.curvature / size / size[:, None])
    kept = eigenvalues > LOST_EIGENVALUE * len(size) * max(float(eigenvalues[-1]), 1e-300)
    root = np.sqrt(np.where(kept, eigenvalues, 1.0))
    residuals = np.where(kept, vectors.T @ (of.gradient / size) / root, 0.0)
    remainder = np.sqrt(max(0.0, of.value - float(residuals @ residuals)))
    rows = np.where(kept, root, 0.0)[:, None] * vectors.T * size
    return np.append(residuals, remainder), np.vstack([rows, np.zeros(len(size))])


def _gram(rows: csr_array, weights: Reals) -> Reals:
    """`rows^T diag(weights) rows` (n, n), full."""
    count = rows.shape[1]
    if count > DENSE_UNKNOWNS:
        return np.asarray((rows.T @ rows.multiply(weights[:, None])).toarray())
    total = np.zeros((count, count))
    root = np.sqrt(weights)
    for i in range(0, rows.shape[0], BLOCK_ROWS):
        block = rows[i : i + BLOCK_ROWS].toarray() * root[i : i + BLOCK_ROWS, None]
        total += block.T @ block
    return total
