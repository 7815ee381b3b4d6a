"""Evaluation of a surface, against scipy and the packages an engineer would otherwise use.

Each peer is timed in turn with the product, on the same net. geomdl evaluates fewer points and its time is scaled;
`peer_share` in the report says by how much. A peer that is not installed is skipped, by name.
"""

import time

import numpy as np
import pytest
from scipy.interpolate import NdBSpline

from bladewright.nurbs.basis import uniform_knots
from bladewright.nurbs.surface import Surface

SCATTERED, GRID = 1_000_000, 1000


def surface():
    u, v = np.meshgrid(np.linspace(0.0, 2.0, 30), np.linspace(0.0, 1.0, 15), indexing="ij")
    net = np.stack([u, v, np.sin(3.0 * u) * np.cos(2.0 * v)], axis=-1)
    return Surface(
        control_points=net, knots_u=uniform_knots(30, 4), knots_v=uniform_knots(15, 3), degree_u=4, degree_v=3
    )


def of_scipy(shape):
    spline = NdBSpline((shape.knots_u, shape.knots_v), np.array(shape.control_points), (shape.degree_u, shape.degree_v))
    return lambda u, v: spline(np.stack([u, v], axis=-1))


def of_splipy(shape, *, tensor=False):
    splipy = pytest.importorskip("splipy")
    bases = [
        splipy.BSplineBasis(degree + 1, np.array(knots))
        for degree, knots in ((shape.degree_u, shape.knots_u), (shape.degree_v, shape.knots_v))
    ]
    net = np.swapaxes(shape.control_points, 0, 1).reshape(-1, 3)
    peer = splipy.Surface(*bases, net)
    return lambda u, v: peer.evaluate(u, v, tensor=tensor)


def of_nurbspy(shape):
    nurbspy = pytest.importorskip("nurbspy")
    peer = nurbspy.NurbsSurface(
        control_points=np.moveaxis(shape.control_points, -1, 0).copy(),
        u_degree=shape.degree_u,
        v_degree=shape.degree_v,
        u_knots=np.array(shape.knots_u),
        v_knots=np.array(shape.knots_v),
    )
    return lambda u, v: np.asarray(peer.get_value(u, v)).T


def of_geomdl(shape):
    geomdl = pytest.importorskip("geomdl.BSpline")
    peer = geomdl.Surface()
    peer.degree_u, peer.degree_v = shape.degree_u, shape.degree_v
    peer.set_ctrlpts(shape.control_points.reshape(-1, 3).tolist(), *shape.control_points.shape[:2])
    peer.knotvector_u, peer.knotvector_v = shape.knots_u.tolist(), shape.knots_v.tolist()
    return lambda u, v: np.array(peer.evaluate_list(np.stack([u, v], axis=-1).tolist()))


def side_by_side(product, peer, rounds):
    """The shortest time of each, run in turn so that other work on the machine meets both."""
    best = [np.inf, np.inf]
    for _ in range(rounds):
        for which, call in enumerate((product, peer)):
            start = time.perf_counter()
            call()
            best[which] = min(best[which], time.perf_counter() - start)
    return best


def compared(benchmark, what, name, product, peer, *, rounds, share=1.0):
    """How many times faster the product is than a peer that does `share` of its work."""
    own, other = side_by_side(product, peer, rounds)
    ratio = other / share / own
    benchmark.extra_info.update(peer=name, peer_share=share, peer_seconds=other / share, times_faster=ratio)
    print(f"\n{what}: {own:.4f} s, {ratio:.2f} times as fast as {name} (timed on {share:.1%} of it)")
    return ratio


PEERS = {
    # name: maker, points that it evaluates, rounds, ratio to reach
    "scipy": (of_scipy, SCATTERED, 5, 1.0 / 1.5),
    "splipy": (of_splipy, SCATTERED, 3, 5.0),
    "nurbspy": (of_nurbspy, SCATTERED, 2, 30.0),
    "geomdl": (of_geomdl, 2_000, 2, 100.0),
}


@pytest.mark.parametrize("name", PEERS)
def test_a_million_scattered_points(benchmark, name):
    make, count, rounds, reach = PEERS[name]
    shape = surface()
    peer = make(shape)
    u, v = np.random.default_rng(0).random((2, SCATTERED))
    few_u, few_v = u[:count], v[:count]
    assert np.allclose(peer(few_u[:50], few_v[:50]), shape(few_u[:50], few_v[:50]), rtol=0.0, atol=1e-12)
    benchmark.pedantic(shape, args=(u, v), rounds=3, warmup_rounds=1)
    ratio = compared(
        benchmark,
        "1,000,000 scattered points",
        name,
        lambda: shape(u, v),
        lambda: peer(few_u, few_v),
        rounds=rounds,
        share=count / SCATTERED,
    )
    assert ratio >= reach


def test_a_grid_of_a_thousand_by_a_thousand(benchmark):
    shape = surface()
    peer = of_splipy(shape, tensor=True)
    at = np.linspace(0.0, 1.0, GRID)
    assert np.allclose(peer(at[:20], at[:30]), shape.grid(at[:20], at[:30]), rtol=0.0, atol=1e-12)
    benchmark.pedantic(shape.grid, args=(at, at), rounds=10, warmup_rounds=1)
    ratio = compared(
        benchmark, "1000 x 1000 grid", "splipy", lambda: shape.grid(at, at), lambda: peer(at, at), rounds=20
    )
    assert ratio >= 2.0
