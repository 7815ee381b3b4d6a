"""How to evaluate a B-spline surface: scattered points and grids, by the ways that numpy and scipy offer.

Run: python design/nurbs_evaluation.py. The result is in design/README.md; `nurbs/surface.py` follows it.
"""

import time

import numpy as np
from scipy.interpolate import BSpline, NdBSpline

DEGREES, COUNTS = (4, 3), (30, 15)
SCATTERED, GRID, ROUNDS = 1_000_000, 1000, 5


def clamped(count, degree):
    return np.concatenate([np.zeros(degree), np.linspace(0.0, 1.0, count - degree + 1), np.ones(degree)])


KNOTS = [clamped(count, degree) for count, degree in zip(COUNTS, DEGREES, strict=True)]
NET = np.random.default_rng(0).random((*COUNTS, 3))


def local_basis(knots, degree, u):
    """First control point (m,) and the degree + 1 basis functions (m, degree + 1) that do not vanish at u (m,)."""
    span = np.clip(np.searchsorted(knots, u, side="right") - 1, degree, len(knots) - degree - 2)
    values = np.ones((len(u), 1))
    for p in range(1, degree + 1):
        raised = np.zeros((len(u), p + 1))
        for r in range(p):
            left, right = knots[span + 1 + r - p], knots[span + 1 + r]
            share = values[:, r] / (right - left)
            raised[:, r] += (right - u) * share
            raised[:, r + 1] += (u - left) * share
        values = raised
    return span - degree, values


def scattered_spline(u, v):
    return NdBSpline(tuple(KNOTS), NET, DEGREES)(np.stack([u, v], axis=-1))


def scattered_numpy(u, v):
    (i, along), (j, across) = (local_basis(*how) for how in zip(KNOTS, DEGREES, (u, v), strict=True))
    total = np.zeros((len(u), 3))
    for a in range(DEGREES[0] + 1):
        for b in range(DEGREES[1] + 1):
            total += (along[:, a] * across[:, b])[:, None] * NET[i + a, j + b]
    return total


def scattered_dense(u, v, block=20_000):
    found = []
    for k in range(0, len(u), block):
        along, across = (dense_basis(d, x[k : k + block]) for d, x in ((0, u), (1, v)))
        rows = (along @ NET.reshape(COUNTS[0], -1)).reshape(-1, COUNTS[1], 3)
        found.append(np.einsum("mj,mjd->md", across, rows))
    return np.concatenate(found)


def scattered_sparse(u, v):
    return NdBSpline.design_matrix(np.stack([u, v], axis=-1), tuple(KNOTS), DEGREES) @ NET.reshape(-1, 3)


def dense_basis(direction, u):
    return BSpline(KNOTS[direction], np.eye(COUNTS[direction]), DEGREES[direction])(u)


def grid_scattered(u, v):
    return scattered_spline(*np.broadcast_arrays(u[:, None], v))


def grid_dense(u, v):
    rows = (dense_basis(0, u) @ NET.reshape(COUNTS[0], -1)).reshape(len(u), COUNTS[1], 3)
    columns = np.swapaxes(rows, 0, 1).reshape(COUNTS[1], -1)
    return np.swapaxes((dense_basis(1, v) @ columns).reshape(len(v), len(u), 3), 0, 1)


def grid_einsum(u, v):
    return np.einsum("iu,uvd,jv->ijd", dense_basis(0, u), NET, dense_basis(1, v), optimize=True)


def grid_sparse(u, v):
    along, across = (BSpline.design_matrix(x, KNOTS[d], DEGREES[d]) for d, x in ((0, u), (1, v)))
    rows = (along @ NET.reshape(COUNTS[0], -1)).reshape(len(u), COUNTS[1], 3)
    columns = np.swapaxes(rows, 0, 1).reshape(COUNTS[1], -1)
    return np.swapaxes((across @ columns).reshape(len(v), len(u), 3), 0, 1)


def grid_splines(u, v):
    rows = BSpline(KNOTS[1], np.swapaxes(NET, 0, 1), DEGREES[1])(v)
    return BSpline(KNOTS[0], np.swapaxes(rows, 0, 1), DEGREES[0])(u)


def seconds(call, parameters):
    best = np.inf
    for _ in range(ROUNDS):
        start = time.perf_counter()
        call(*parameters)
        best = min(best, time.perf_counter() - start)
    return best


def main():
    u, v = np.random.default_rng(1).random((2, SCATTERED))
    at = np.linspace(0.0, 1.0, GRID)
    tables = {
        f"{SCATTERED:,} scattered points": (
            (u, v),
            {
                "scipy NdBSpline": scattered_spline,
                "numpy, local basis functions, a gather for each": scattered_numpy,
                "dense basis matrices": scattered_dense,
                "sparse matrix of all basis functions (NdBSpline.design_matrix)": scattered_sparse,
            },
        ),
        f"{GRID} x {GRID} grid": (
            (at, at),
            {
                "scipy NdBSpline at every point": grid_scattered,
                "dense basis matrices, two products": grid_dense,
                "dense basis matrices, einsum": grid_einsum,
                "sparse basis matrices (BSpline.design_matrix)": grid_sparse,
                "BSpline of a net of BSplines": grid_splines,
            },
        ),
    }
    size, degrees = "{} x {}".format(*COUNTS), "{} x {}".format(*DEGREES)
    print(f"A surface of {size} control points, degree {degrees}; best of {ROUNDS} runs")
    for title, (parameters, ways) in tables.items():
        expected = next(iter(ways.values()))(*parameters)
        print(f"\n{title:64}    [ms]  largest difference")
        for name, way in ways.items():
            error = np.max(np.abs(way(*parameters) - expected))
            print(f"  {name:62} {1e3 * seconds(way, parameters):7.1f}  {error:.1e}")


if __name__ == "__main__":
    main()
