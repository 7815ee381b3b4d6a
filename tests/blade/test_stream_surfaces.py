"""Native stream surfaces: lengths, edges, planes and the way back, against closed forms and against T-Blade3."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bladewright.blade.design.flow_path import FlowPath
from bladewright.blade.exact.prescribed_edges import PrescribedEdges
from bladewright.blade.flow_path.quasi_orthogonals import fractions_at
from bladewright.blade.flow_path.stream_surface_map import (
    Cascade,
    Conformal,
    DiscreteConformal,
    Projected,
    Unrolled,
    plane_of,
)
from bladewright.blade.flow_path.stream_surfaces import stream_surfaces
from bladewright.blade.flow_path.streamlines import stream_lines
from bladewright.errors import DesignError
from bladewright.files.tblade3 import read_tblade3
from bladewright.numerics.elementary import cross2
from machines.flow_paths import BEND, CONE, CYLINDER, DISC, DUCT, GIVEN, IMPELLER, MACHINES, through

V = np.array([0.0, 0.21, 0.5, 0.83, 1.0])
ROUNDING = 4e-15
each_machine = pytest.mark.parametrize("machine", MACHINES.values(), ids=MACHINES)


def bend_conformal(radius, start, end, centre=3.0):
    """m' of an arc of a torus, r = centre - radius cos(phi), by its closed form."""

    def antiderivative(phi):
        factor = np.sqrt((centre + radius) / (centre - radius))
        return 2.0 * radius / np.sqrt(centre**2 - radius**2) * np.arctan(factor * np.tan(phi / 2.0))

    return antiderivative(end) - antiderivative(start)


CLOSED = {
    "cylinder": (CYLINDER, 1.0 + 0.0 * V, 1.0 / (1.0 + V)),
    "cone": (CONE, 0.5 * 5.0**0.5 + 0.0 * V, np.sqrt(5.0) * np.log((1.75 + V) / (1.25 + V))),
    "disc": (DISC, 1.0 + 0.0 * V, np.log(2.5 / 1.5) + 0.0 * V),
    "bend": (
        BEND,
        (2.0 - V) * (np.arccos(0.5 / (2.0 - V)) - np.arcsin(0.3 / (2.0 - V))),
        bend_conformal(2.0 - V, np.arcsin(0.3 / (2.0 - V)), np.arccos(0.5 / (2.0 - V))),
    ),
}


@pytest.mark.parametrize("name", CLOSED)
def test_lengths_and_conformal_lengths_between_edges_are_those_of_closed_forms(name):
    machine, lengths, conformal = CLOSED[name]
    lines = machine.bladed().lines(V, Conformal())
    np.testing.assert_allclose(lines.extents(), conformal, rtol=ROUNDING)
    np.testing.assert_allclose(lines.lengths, lengths, rtol=ROUNDING)
    np.testing.assert_allclose(machine.bladed().lines(V, Unrolled()).extents(), lengths, rtol=ROUNDING)


def test_stream_lines_of_a_bend_are_concentric_arcs():
    surfaces = BEND.surfaces()
    lines = stream_lines(surfaces, Cascade(), V, 0.0, 0.0)
    t = np.linspace(0.0, 1.0, 41)
    points = lines.position(t)
    expected = (2.0 - V)[:, None, None] * np.stack([np.sin(t * np.pi / 2), -np.cos(t * np.pi / 2)], axis=-1)
    np.testing.assert_allclose(points, expected + np.array([0.0, 3.0]), atol=4e-15)


@each_machine
def test_hub_shroud_and_given_stream_surfaces_are_met_exactly(machine):
    surfaces = machine.surfaces()
    curves = [machine.path.hub, *machine.path.stream_surfaces, machine.path.shroud]
    t = np.linspace(surfaces.low, surfaces.high, 33)
    for curve, v in zip(curves, surfaces.spans, strict=True):
        points = surfaces.position(np.array([v]), t[None])[0]
        fine = curve.line(1.0).values(np.linspace(0.0, 1.0, 20001))
        gaps = np.min(np.linalg.norm(points[:, None] - fine, axis=2), axis=1)
        # half a step of the fine places along the line, squared over its radius of curvature, and none beside it
        assert np.max(gaps) < 0.5 * np.max(np.linalg.norm(np.diff(fine, axis=0), axis=1)) * 1.01


@each_machine
def test_a_walls_own_parameter_belongs_to_its_t(machine):
    surfaces = machine.surfaces()
    t = np.linspace(surfaces.low, surfaces.high, 33)
    for v, name in ((0.0, "hub"), (1.0, "shroud")):
        points = surfaces.wall(name).values(surfaces.wall_parameter(name, t))
        np.testing.assert_allclose(points, surfaces.position(np.array([v]), t[None])[0], atol=5e-15)


@pytest.mark.parametrize("machine", [CONE, DUCT, IMPELLER, GIVEN], ids=["cone", "duct", "impeller", "given"])
def test_quasi_orthogonals_join_equal_fractions_of_the_lengths(machine):
    surfaces = machine.surfaces()
    pairs = np.array([(0.0, 0.0), *machine.path.quasi_orthogonals, (1.0, 1.0)])
    for match, curve, fractions in zip(
        (surfaces.matches[0], surfaces.matches[-1]), (surfaces.curves[0], surfaces.curves[-1]), pairs.T, strict=True
    ):
        np.testing.assert_allclose(fractions_at(match, pairs.mean(axis=1)), fractions, atol=1e-15)
        t = fractions_at(match, np.linspace(0.0, 1.0, 9))
        # the fraction of the length is found again at the point
        np.testing.assert_allclose(curve.fraction_at(curve.parameter_at(t)), t, atol=1e-14)


@each_machine
@pytest.mark.parametrize("mapping", [Conformal(), Unrolled()], ids=["m'-theta", "m-r*theta"])
def test_the_abscissa_is_inverted_to_rounding(machine, mapping):
    lines = machine.bladed().lines(V, mapping)
    u = np.linspace(-0.02, 1.02, 23)
    abscissa = lines.abscissa(u)
    np.testing.assert_allclose(lines.u_at(abscissa), np.broadcast_to(u, abscissa.shape), atol=1e-13)


@each_machine
@pytest.mark.parametrize("mapping", [Conformal(), Unrolled()], ids=["m'-theta", "m-r*theta"])
def test_plane_points_go_to_space_and_back(machine, mapping):
    lines = machine.bladed().lines(V, mapping)
    rng = np.random.default_rng(4)
    u, tangential = rng.uniform(0.0, 1.0, 6), rng.uniform(-3.0, 3.0, (len(V), 6))
    ordinate = mapping.start(tangential, lines.position(u)[..., 1], lines.lengths[..., None])
    plane = np.stack([lines.abscissa(u), ordinate], axis=-1)
    position = lines.position(lines.u_at(plane[..., 0]))
    tangential = mapping.tangential(plane[..., 1], position[..., 1], lines.lengths[..., None])
    points = mapping.in_space(position[..., 0], position[..., 1], tangential)
    radius = np.hypot(points[..., 1], points[..., 2])
    np.testing.assert_allclose(np.stack([points[..., 0], radius], axis=-1), lines.position(u), rtol=1e-12, atol=1e-13)
    theta = np.arctan2(points[..., 1], points[..., 2])
    np.testing.assert_allclose(mapping.start(theta, radius, lines.lengths[..., None]), ordinate, rtol=1e-12)


@pytest.mark.parametrize("mapping", [Cascade(), Projected()], ids=["m-y", "x-y"])
def test_planes_of_a_cascade_go_to_space_and_back(mapping):
    machine = GIVEN
    lines = machine.bladed(revolved=False).lines(V, mapping)
    plane = np.stack([lines.abscissa(np.linspace(0.1, 0.9, 5)), 0.1 * np.ones((len(V), 5))], axis=-1)
    position = lines.position(lines.u_at(plane[..., 0]))
    points = mapping.in_space(position[..., 0], position[..., 1], plane[..., 1])
    if mapping.plane == "x-y":
        leading = lines.position(np.array([0.0]))[..., 0]
        np.testing.assert_allclose(points[..., 0] - leading, plane[..., 0], atol=1e-14)
    np.testing.assert_allclose(points[..., 1], plane[..., 1], rtol=0.0)


def test_a_plane_is_known_by_its_name():
    for name, arrangement, plane in (
        ("m'-theta", "annular", "m'-theta"),
        ("m-r*theta", "annular", "m-r*theta"),
        ("x-y", "linear", "x-y"),
        ("m'-theta", "linear", "m-y"),
    ):
        assert plane_of(name, arrangement).plane == plane
    with pytest.raises(DesignError, match="plane is 'x-y': it must be one of"):
        plane_of("x-y", "annular")


def test_sections_cannot_be_laid_out_by_x_where_x_stands_still():
    with pytest.raises(DesignError, match="does not go forwards in x"):
        DISC.bladed(revolved=False).lines(V, Projected())


@each_machine
def test_edges_lie_on_their_curves_and_on_the_stream_lines(machine):
    bladed = machine.bladed()
    lines = bladed.lines(V, Conformal())
    for u, edge in ((0.0, bladed.leading_edge), (1.0, bladed.trailing_edge)):
        points = lines.position(np.array([u]))[:, 0]
        places = np.linspace(-0.05, 1.05, 4001)
        curve = edge.values(places)
        for point in points:
            near = np.argsort(np.linalg.norm(curve - point, axis=1))[:2]
            along = curve[near[1]] - curve[near[0]]
            off = np.linalg.det([along, point - curve[near[0]]]) / np.linalg.norm(along)
            # the chord between two of 4000 places is off the curve by its square over eight radii of curvature
            assert abs(off) < 1e-7 * np.linalg.norm(curve[-1] - curve[0])
    np.testing.assert_allclose(lines.t(np.array([0.0]))[:, 0], bladed.edges(V)[0], atol=1e-15)


def quantities(machine, mapping, abscissa):
    """What a blade takes from its flow path, at fixed v and u and at fixed places in the plane, (..., k)."""
    bladed = machine.bladed()
    lines = bladed.lines(V[1:4], mapping)
    parts = [
        lines.position(np.array([0.0, 0.37, 1.0])), lines.position(np.array([1.0]), 1),
        lines.position(lines.u_at(abscissa[:, None])), lines.extents(), lines.lengths, *bladed.edges(V[1:4]),
    ]  # fmt: skip
    batch = np.broadcast_shapes(*[part.shape[:1] for part in parts[4:5] if part.ndim > 1])
    return np.concatenate(
        [np.broadcast_to(part, (*batch, *part.shape[len(batch) :])).reshape(*batch, -1) for part in parts], axis=-1
    )


def fixed_places(machine, mapping):
    lines = machine.bladed().lines(V[1:4], mapping)
    return 0.31 * lines.extents()


def moved(machine, change):
    """The machine with numbers added to its parameters, in their order."""
    return machine.changed(
        {path: value + by for (path, value), by in zip(machine.parameters().items(), change, strict=True)}
    )


@pytest.mark.parametrize(
    ("name", "mapping"),
    [*((name, Conformal()) for name in MACHINES if name != "bend"), ("impeller", Unrolled()), ("uneven", Unrolled())],
    ids=lambda value: value if isinstance(value, str) else value.plane,
)
def test_everything_carries_an_imaginary_step_of_every_parameter(name, mapping):
    machine = MACHINES[name]
    places = fixed_places(machine, mapping)
    count = len(machine.parameters())
    # all parameters at once: each a batch with the step in its own member
    jacobian = np.imag(quantities(moved(machine, 1e-30j * np.eye(count)), mapping, places)) / 1e-30
    if machine not in (CYLINDER, CONE, DISC):
        # points on a straight line may move along it without effect
        for path, row in zip(machine.parameters(), jacobian, strict=True):
            assert np.max(np.abs(row)) > 1e-6, f"{path} has no effect"
    size = float(np.max(np.abs(list(machine.parameters().values()))))
    rng = np.random.default_rng(11)
    for _ in range(2):
        way = rng.uniform(-1.0, 1.0, count)
        step = 2e-6 * size
        up, down = (quantities(moved(machine, sign * step * way), mapping, places) for sign in (1.0, -1.0))
        scale = np.max(np.abs(way @ jacobian))
        # central differences: the square of the step times third derivatives, and rounding over the step
        np.testing.assert_allclose(way @ jacobian, (up - down) / (2.0 * step), rtol=1e-6, atol=1e-8 * scale)


def test_a_batch_of_flow_paths_is_its_members():
    places = fixed_places(IMPELLER, Conformal())
    values = IMPELLER.parameters()["path.hub.control_points[2].r"] + 1e-30j * np.arange(3)
    both = quantities(IMPELLER.changed("path.hub.control_points[2].r", values), Conformal(), places)
    for i, value in enumerate(values):
        one = quantities(IMPELLER.changed("path.hub.control_points[2].r", value), Conformal(), places)
        np.testing.assert_allclose(both[i].real, one.real, rtol=1e-14)
        np.testing.assert_allclose(both[i].imag, np.imag(one), rtol=1e-11, atol=1e-42)


def test_an_edge_drawn_a_little_short_is_continued_to_the_wall():
    short = CYLINDER.changed("leading_edge", through((0.0, 1.03), (0.1, 1.97)))
    points = short.bladed().lines(V, Conformal()).position(np.array([0.0]))[:, 0]
    np.testing.assert_allclose(points[:, 0], 0.1 * (points[:, 1] - 1.03) / 0.94, atol=1e-15)
    np.testing.assert_allclose(points[[0, -1], 1], [1.0, 2.0], atol=1e-15)


DATA = Path(__file__).parents[3] / "shared" / "data" / "tblade3"
CASES = sorted(path.name for path in DATA.iterdir() if path.is_dir()) if DATA.is_dir() else []
needs_data = pytest.mark.skipif(not CASES, reason="the reference cases of T-Blade3 are not beside the repository")
each_case = pytest.mark.parametrize("name", CASES or [pytest.param("", marks=needs_data)])
ROOTS = 1e-11
"""T-Blade3 stops its own search for an edge's place up to 7.5e-12 away from it"""


def of_tblade3(name):
    """A case's flow path, matched at its edges, both edges, and T-Blade3's own m' and (x, r) of the edges."""
    (main,) = (DATA / name / "input").glob("3dbgbinput.*.dat")
    case = read_tblade3(main)
    curves = [through(*points, spacing="conformal", ends="released") for points in case.streamlines]
    path = FlowPath(hub=curves[0], shroud=curves[-1], stream_surfaces=tuple(curves[1:-1]), matched="edges")
    edges = [through(*points, ends="released") for points in (case.leading_curve, case.trailing_curve)]
    (cascade,) = (DATA / name / "output").glob("cascade_nondim.*")
    rows = [line.split() for line in cascade.read_text().splitlines()[3:]]
    counted = np.array([[float(value) for value in row[1:3]] for row in rows if row and row[0].isdigit()])
    (meetings,) = (DATA / name / "output").glob("LE_TE_intersection.*")
    return path, edges, counted, np.loadtxt(meetings).reshape(-1, 2, 2)


@each_case
def test_edges_and_their_m_are_those_of_tblade3(name):
    path, edges, counted, meetings = of_tblade3(name)
    surfaces = stream_surfaces(path, 1.0, tuple(edges))
    v = surfaces.spans
    leading, trailing = (edge.line(1.0) for edge in edges)
    place = PrescribedEdges(surfaces=surfaces, leading_edge=leading, trailing_edge=trailing)
    t = np.stack(place.edges(v), axis=-1)
    first, rate = surfaces.counted(v)
    np.testing.assert_allclose(first[:, None] + rate[:, None] * t, counted, rtol=0.0, atol=ROOTS)
    np.testing.assert_allclose(surfaces.position(v, t), meetings, rtol=0.0, atol=ROOTS)
    # at T-Blade3's own m' the stream lines are its own to rounding, wherever its search stopped
    own = (counted - first[:, None]) / rate[:, None]
    np.testing.assert_allclose(surfaces.position(v, own), meetings, rtol=0.0, atol=1e-15)


def test_the_plane_of_a_counted_m_is_linear_between_the_edges():
    lines = GIVEN.bladed().lines(V, DiscreteConformal())
    u = np.linspace(-0.1, 1.1, 13)
    np.testing.assert_allclose(lines.abscissa(u), lines.extents()[:, None] * u, atol=1e-15)
    np.testing.assert_allclose(lines.u_at(lines.abscissa(u)), np.broadcast_to(u, (len(V), 13)), atol=1e-14)
    np.testing.assert_allclose(lines.densities(u)[0], np.broadcast_to(lines.extents()[:, None], (len(V), 13)))
    exact = GIVEN.bladed().lines(V, Conformal())
    # four chords in place of the integral
    np.testing.assert_allclose(lines.extents(), exact.extents(), rtol=0.02)
    assert np.max(np.abs(lines.extents() / exact.extents() - 1.0)) > 1e-4


@each_machine
def test_densities_are_the_derivatives_of_the_abscissa(machine):
    lines = machine.bladed().lines(V, Conformal())
    u, step = np.array([0.2, 0.55]), 1e-4
    before, here, after = (lines.abscissa(u + by) for by in (-step, 0.0, step))
    first, second = lines.densities(u)
    np.testing.assert_allclose((after - before) / (2.0 * step), first, rtol=3e-6)
    np.testing.assert_allclose(
        (lines.densities(u + step)[0] - lines.densities(u - step)[0]) / (2.0 * step), second, rtol=1e-4, atol=1e-4
    )
    del here


@each_machine
def test_stream_surfaces_have_the_derivatives_they_say(machine):
    surfaces = machine.surfaces()
    t = np.linspace(surfaces.low, surfaces.high, 7)[1:-1] + 1e-3
    v, step = np.full(5, 0.46), 1e-6
    _, along, across = surfaces.at(t, v)
    for got, expected in (
        ((surfaces.at(t + step, v)[0] - surfaces.at(t - step, v)[0]), along),
        ((surfaces.at(t, v + step)[0] - surfaces.at(t, v - step)[0]), across),
    ):
        np.testing.assert_allclose(got / (2.0 * step), expected, atol=1e-8 * np.max(np.abs(expected)) + 1e-9)
    point, by_t, by_v = surfaces.grid(t, v[:2])
    np.testing.assert_allclose(point[:, 0], surfaces.at(t, v)[0], atol=1e-15)
    np.testing.assert_allclose(by_t[:, 1], along, atol=1e-14)
    np.testing.assert_allclose(by_v[:, 1], across, atol=1e-14)


def test_stream_lines_of_given_surfaces_carry_only_their_own_joints():
    surfaces = GIVEN.surfaces()
    all_of_them = len(surfaces.joints())
    assert len(surfaces.along(surfaces.spans[1:2]).joints()) == 3
    assert all_of_them > 3
    assert len(surfaces.along(np.array([0.4])).joints()) == all_of_them


def test_stream_surfaces_between_given_ones_keep_two_derivatives_across():
    surfaces = GIVEN.surfaces()
    step = 1e-7
    for v in surfaces.span_joints():
        for order in range(3):
            before, after = (surfaces.shares(np.array([v + sign * step]), order) for sign in (-1.0, 1.0))
            # a step times the next derivative, of at most 1e4
            np.testing.assert_allclose(before, after, atol=5e-3 if order == 2 else 1e-4)
    np.testing.assert_allclose(surfaces.shares(surfaces.spans), np.eye(len(surfaces.spans)), atol=0.0)


CROSSED = FlowPath(
    hub=through((-60, 175), (-30, 120), (0, 95), (40, 103), (120, 110)),
    shroud=through((-60, 170), (-30, 169), (0, 169), (40, 166), (120, 160)),
    stream_surfaces=(through((-60, 130), (-30, 130), (0, 131), (40, 134), (120, 135)),),
    matched="edges",
)
EDGES = through((0, 80), (2, 130), (6, 180)), through((38, 90), (34, 130), (28, 180))


def test_surfaces_matched_at_the_edges_end_where_lines_far_from_the_blade_cross():
    whole = stream_surfaces(replace(CROSSED, hub=through((-60, 90), (0, 95), (40, 103), (120, 110))), 1e-3, EDGES)
    cut = stream_surfaces(CROSSED, 1e-3, EDGES)
    assert whole.low < -1.2 < cut.low < -0.1
    assert cut.high == pytest.approx(whole.high, rel=0.05)
    t, v = np.linspace(cut.low, cut.high, 301), np.linspace(0.0, 1.0, 61)
    _, along, across = cut.grid(t, v)
    assert np.min(cross2(along, across)) > 0.0


def test_lines_that_cross_at_the_blade_are_refused_still():
    hub = through((-60, 90), (0, 95), (20, 150), (40, 103), (120, 110))
    with pytest.raises(DesignError, match="the stream surfaces fold over"):
        stream_surfaces(replace(CROSSED, hub=hub), 1e-3, EDGES)
