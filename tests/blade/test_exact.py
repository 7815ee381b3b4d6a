"""The exact blade against the plane section, closed forms and the paper's map."""

import numpy as np
import pytest

from bladewright.blade.design.flow_path import Channel
from bladewright.blade.design.unified import UnifiedBlade
from bladewright.blade.exact.unified import KEPT_LINES, exact_unified_blade
from bladewright.section.unified import UnifiedSection
from machines.unified import CASCADE, FAN, IMPELLER

SHAPE = {
    "length_unit": "m",
    "stagger": 30.0,
    "metal_angle_in": 45.0,
    "metal_angle_out": 10.0,
    "tangent_in": 0.3,
    "tangent_out": 0.4,
    "leading_edge_radius": 0.01,
    "trailing_edge_radius": 0.005,
    "thickness_upper": (0.05, 0.08, 0.03),
    "thickness_lower": (0.04, 0.06, 0.03),
}
S = np.linspace(0.0, 1.0, 33)


def test_on_a_cylinder_the_blade_is_the_unrolled_2d_section():
    radius = 2.0
    blade = exact_unified_blade(
        UnifiedBlade(
            **SHAPE,
            name="cylinder",
            blade_count=5,
            channel=Channel(leading_edge=((0.0, radius), (0.0, 3.0)), trailing_edge=((1.0, radius), (1.0, 3.0))),
        )
    )
    section = UnifiedSection(**SHAPE, name="flat", axial_chord=1.0).build()
    points = blade.sections(np.array([0.0])).points(S)
    for name, side in zip(("upper", "lower"), points, strict=True):
        x, y, z = side[0].T
        assert y**2 + z**2 == pytest.approx(np.full(len(S), radius**2), rel=1e-14)
        unrolled = np.stack([x, radius * np.arctan2(y, z)], axis=-1)
        dense = section.curves[name](np.linspace(0.0, 1.0, 100001))
        away = np.min(np.linalg.norm(unrolled[:, None] - dense[None], axis=-1), axis=1)
        assert np.max(away) < 2e-5  # the spacing of the dense points


def test_theta_turns_z_towards_y():
    design = FAN.changed({"leading_edge_theta": 90.0})
    edge = exact_unified_blade(design).sections(np.array([0.0])).leading_edge()
    assert edge.point[0, 1] == pytest.approx(95.0e-3, rel=1e-12)
    assert edge.point[0, 2] == pytest.approx(0.0, abs=1e-15)


def test_a_cascades_span_is_z_and_its_pitchwise_direction_y():
    stations = exact_unified_blade(CASCADE).sections(np.array([0.0, 1.0]))
    edge = stations.leading_edge()
    assert edge.point == pytest.approx(np.array([[0.0, 0.0, 0.0], [1e-3, 2e-3, 0.1]]), abs=1e-15)


def test_the_mean_line_turns_by_the_stagger_in_the_conformal_plane(design):
    stations = exact_unified_blade(design).sections(np.linspace(0.0, 1.0, 5))
    ends = stations.plane.camber[:, [0, 3]]
    from bladewright.section.laws import Span

    slope = (ends[:, 1, 1] - ends[:, 0, 1]) / (ends[:, 1, 0] - ends[:, 0, 0])
    assert np.degrees(np.arctan(slope)) == pytest.approx(Span(stations.v).values(design.stagger), abs=1e-11)
    assert ends[:, 1, 0] - ends[:, 0, 0] == pytest.approx(stations.lines.extents(), rel=1e-14)


def test_edge_derivatives_are_those_of_the_points_along_both_sides(design):
    stations = exact_unified_blade(design).sections(np.linspace(0.0, 1.0, 4))
    errors = []
    for step in (5e-4, 2.5e-4):
        at = step * np.arange(7)
        near, far = stations.points(at), stations.points(1.0 - at[::-1])
        fit = np.linalg.inv(np.vander(at, increasing=True))
        worst = 0.0
        for row, sides, flip in ((stations.leading_edge(), near, 1.0), (stations.trailing_edge(), far, -1.0)):
            for points, sign in zip(sides, (1.0, -1.0), strict=True):
                series = np.einsum("kj,vjd->vkd", fit, points if flip > 0 else points[:, ::-1])
                first, second = series[:, 1] * flip * sign, 2.0 * series[:, 2]
                worst = max(worst, np.max(np.abs(first - row.first)) / np.max(np.abs(row.first)))
                worst = max(worst, np.max(np.abs(second - row.second)) / np.max(np.abs(row.second)))
        errors.append(worst)
    # one-sided differences of order five for the second derivative: a 32nd each time, until rounding takes over
    assert errors[1] < 2e-5
    assert errors[1] < errors[0] / 12.0 or errors[1] < 2e-7


def test_the_papers_mapping_is_its_equation_28():
    design = IMPELLER.changed("mapping", "paper")
    blade = exact_unified_blade(design)
    stations = blade.sections(np.array([0.4]))
    plane = stations.plane_points(S)[0]
    meridional = stations.lines.position(plane[..., 0])
    x, radius = meridional[0].T
    y = plane[0, :, 1] * stations.lines.lengths[0]
    expected = np.stack([x, radius * np.sin(y / radius), radius * np.cos(y / radius)], axis=-1)
    assert stations.points(S)[0][0] == pytest.approx(expected, abs=1e-15)


def test_the_papers_mapping_misses_the_metal_angle_by_degrees():
    promises = FAN.changed("mapping", "paper").build().conformance
    assert promises.metal_angle_between > 3.0
    assert promises.edge_radius > 0.05
    assert promises.kept


def test_every_parameter_moves_the_blade_and_its_complex_step_is_its_derivative():
    values, v = IMPELLER.parameters(), np.linspace(0.0, 1.0, 5)
    paths = list(values)

    def points(changes):
        return np.stack(exact_unified_blade(IMPELLER.changed(changes)).sections(v).points(S))

    analytic = np.stack([np.imag(points({path: value + 1e-30j})) / 1e-30 for path, value in values.items()])
    largest = np.max(np.abs(analytic), axis=(1, 2, 3, 4))
    assert [path for path, size in zip(paths, largest, strict=True) if size == 0.0] == []
    # all at once, each by a share of its own of what moves points alike, so that none can be wrong unseen
    way = np.random.default_rng(5).uniform(0.5, 1.0, len(paths)) / largest
    found = np.tensordot(way, analytic, axes=1)
    step = 1e-5 * min(max(1e-2, abs(values[path])) / each for path, each in zip(paths, way, strict=True))

    def moved(by):
        return points({path: values[path] + by * each for path, each in zip(paths, way, strict=True)})

    central = (8.0 * (moved(step) - moved(-step)) - (moved(2.0 * step) - moved(-2.0 * step))) / (12.0 * step)
    # fourth-order differences: rounding over the step rules, 1e-16 x size / step
    assert found == pytest.approx(central, abs=1e-6 * np.max(np.abs(found)) + 1e-16 / step)


def test_a_batch_of_imaginary_steps_is_the_single_steps_one_by_one():
    paths = ["stagger[1]", "channel.hub[1].r", "thickness_lower[2]", "leading_edge_radius", "channel.leading_edge[0].x"]
    values = IMPELLER.parameters()
    changes = {}
    for i, path in enumerate(paths):
        steps = np.full(len(paths), values[path], dtype=complex)
        steps[i] += 1e-30j
        changes[path] = steps
    v = np.linspace(0.0, 1.0, 3)
    batch = np.stack(exact_unified_blade(IMPELLER.changed(changes)).sections(v).points(S))
    for i, path in enumerate(paths):
        single = np.stack(exact_unified_blade(IMPELLER.changed(path, values[path] + 1e-30j)).sections(v).points(S))
        scale = np.max(np.abs(np.imag(single)))
        assert np.imag(batch[:, i]) == pytest.approx(np.imag(single), abs=1e-13 * scale)


def test_stream_lines_of_many_panels_are_those_of_few_and_a_batch_is_each_of_its_points():
    lines = exact_unified_blade(FAN.changed({"tip_clearance": 0.01})).sections(np.array([0.2, 0.9])).lines
    assert len(lines.panels) > 5
    u = np.random.default_rng(3).uniform(0.0, 1.0, (4, 2, 7))
    for together, each in (
        (lines.abscissa(u), lines.abscissa),
        (lines.position(u, 1), lambda at: lines.position(at, 1)),
    ):
        assert np.array_equal(together, np.stack([each(at) for at in u]))
    assert lines.u_at(lines.abscissa(u)) == pytest.approx(u, abs=1e-14)
    step = 1e-30j * np.ones(u.shape[1:])
    assert np.imag(lines.u_at(lines.abscissa(u[0] + step))) == pytest.approx(np.imag(step), rel=1e-12)


def test_designs_of_one_channel_share_its_stream_lines_of_which_the_last_are_kept():
    blade, v = exact_unified_blade(FAN), np.array([0.3, 0.7])
    lines = blade.sections(v).lines
    turned = FAN.changed({"stagger[0]": 12.0})
    assert blade.moved_to(turned).sections(v).lines is lines
    for changes in ({"channel.shroud[0].r": 1.001 * FAN.parameters()["channel.shroud[0].r"]}, {"tip_clearance": 0.01}):
        moved = blade.moved_to(FAN.changed(changes)).sections(v)
        assert moved.lines is not lines
        assert np.max(np.abs(moved.lines.lengths - lines.lengths)) > 0.0
    for place in np.linspace(0.0, 1.0, 3 * KEPT_LINES):
        blade.sections(np.array([place]))
    assert len(blade.known_lines) <= KEPT_LINES
