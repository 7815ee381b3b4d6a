"""Stacking by reference points, sweep and lean: points stand where they are asked, and sections stay as they are."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from bladewright import cad
from bladewright.blade.design.flow_path import FlowPath
from bladewright.blade.exact.orthogonal_trajectory import orthogonal_trajectory
from bladewright.blade.exact.placement import centroid, reference_points
from bladewright.blade.exact.sectioned import exact_sectioned_blade
from bladewright.blade.flow_path.stream_surfaces import stream_surfaces
from bladewright.blade.native.conformance import twist_of
from bladewright.errors import DesignError
from bladewright.numerics.elementary import length
from bladewright.nurbs.surface import Surface
from bladewright.section.laws import Span
from machines import built, stacked
from machines.sectioned import COMPRESSOR, IMPELLER, VANE, through

V = np.array([0.0, 0.21, 0.5, 0.77, 1.0])
SPAN = Span(V)
MM = 1e-3
NAMES = [design.name for design in stacked.ALL]


def unshifted(design):
    return replace(design, sweep=None, lean=None, conformal_sweep=None)


def reference(design, v=V):
    """Reference points: (x, r), and theta or y, (m, ...) each, with the sections."""
    sections = exact_sectioned_blade(design, checked=False).design_sections(v)
    points = reference_points(design.stacking, sections.outline, Span(v))
    _, position, tangential = sections.on_lines(sections.placed(points[:, None, :]))
    return position[:, 0], tangential[:, 0], sections


def test_the_centre_of_area_is_that_of_the_native_section():
    # its plane is metric; its curves lie within 1e-10 of the exact section
    exact = exact_sectioned_blade(VANE)
    section, plane = exact.section(0.5), exact.design_sections(np.array([0.5]))
    assert plane.placed(centroid(plane.outline)[:, None])[0, 0] == pytest.approx(section.centroid, abs=1e-9 * 0.04)


@pytest.mark.parametrize(
    "design", [each for each in stacked.PLACED if each is not stacked.RADIAL], ids=lambda design: design.name
)
def test_reference_points_stand_where_they_are_asked(design):
    design, stacking = unshifted(design), design.stacking
    position, tangential, _ = reference(design)
    if stacking.onwards == "equal-x" and stacking.hub_x is not None:
        assert position[:, 0] == pytest.approx(stacking.hub_x * MM, abs=1e-14)
    if stacking.line is not None:
        line = stacking.line.line(MM)
        off = length(line.values(np.linspace(0.0, 1.0, 4001))[None] - position[:, None])
        # half the distance of the places on the line
        assert np.max(np.min(off, axis=1)) < 1.5e-5
    if design.arrangement == "annular":
        asked = np.radians(SPAN.values(0.0 if stacking.theta is None else stacking.theta))
    else:
        asked = MM * SPAN.values(stacking.y)
    assert tangential == pytest.approx(asked, abs=1e-14)


@pytest.mark.parametrize(
    "design", [each for each in stacked.PLACED if each.stacking.chord is not None], ids=lambda design: design.name
)
def test_the_chord_is_what_it_is_said_to_be(design):
    sections = reference(unshifted(design))[2]
    own = length(np.diff(sections.lines.position(np.linspace(0.0, 1.0, 4001)), axis=1)).sum(axis=1)
    if design.plane == "x-y":
        own = sections.lines.extents()
    asked = MM * SPAN.values(design.stacking.chord) * np.cos(sections.stagger)
    # chords of a curve in 4,000 steps
    assert own == pytest.approx(asked, rel=1e-7)
    if design.plane != "x-y":
        assert sections.lines.lengths == pytest.approx(asked, rel=1e-13)


def test_the_line_of_least_distance_through_a_pencil_of_stream_lines_is_a_circle():
    # the stream lines r = 1 + v (1 + x) all come from (-1, 1)
    fan = stream_surfaces(FlowPath(hub=through((0, 1), (2, 1)), shroud=through((0, 2), (2, 4))), 1.0)
    t = orthogonal_trajectory(fan, np.asarray(0.75)).t(V)
    x, r = fan.position(V, t[:, None])[:, 0].T
    assert (x + 1.0) ** 2 + (r - 1.0) ** 2 == pytest.approx(2.5**2, rel=1e-13)


def test_the_line_of_least_distance_is_that_of_another_solver():
    surfaces = stream_surfaces(IMPELLER.flow_path, MM)
    start = 0.45

    def rate(v, t):
        _, along, across = surfaces.at(np.asarray(t), np.array([min(v, 1.0)]))
        return -np.sum(along * across, axis=-1) / np.sum(along**2, axis=-1)

    found = orthogonal_trajectory(surfaces, np.asarray(start))
    assert len(found.joints) > 0
    other = solve_ivp(rate, (0.0, 1.0), [start], "DOP853", V, rtol=1e-13, atol=1e-14, max_step=0.02)
    assert found.t(V) == pytest.approx(other.y[0], abs=1e-12)


def meridional_length(lines, points):
    """From the leading edge to points (m, 2) on the stream lines."""
    found = []
    for i, point in enumerate(points):
        own = lines.rows([i])

        def ahead(u, own=own, point=point):
            at = np.array([u])
            return np.dot(own.position(at)[0, 0] - point, own.position(at, 1)[0, 0])

        found.append(own.meridional(np.array([brentq(ahead, -0.5, 1.5, xtol=1e-15)]))[0, 0])
    return np.array(found)


@pytest.mark.parametrize("design", [stacked.AXIAL, stacked.LINE, stacked.RETURN, stacked.CASCADE, stacked.BESIDE])
def test_sweep_and_lean_are_shifts_by_their_lengths_of_sections_that_stay_as_they_are(design):
    before, turned, still = reference(unshifted(design))
    after, moved, sections = reference(design)
    assert sections.plane_points(V)[0] - sections.start[:, None, None] * [0.0, 1.0] == pytest.approx(
        still.plane_points(V)[0] - still.start[:, None, None] * [0.0, 1.0], abs=1e-14
    )
    assert sections.lines.extents() == pytest.approx(still.lines.extents(), rel=1e-12)
    sweep, lean = (MM * SPAN.values(0.0 if law is None else law) for law in (design.sweep, design.lean))
    if design.shift_directions == "chordwise-normal":
        cos, sin = np.cos(still.stagger), np.sin(still.stagger)
        sweep, lean = sweep * cos - lean * sin, sweep * sin + lean * cos
    around = (moved - turned) * (after[:, 1] if design.arrangement == "annular" else 1.0)
    assert around == pytest.approx(lean, abs=1e-14)
    if design.conformal_sweep is None:
        ends = [meridional_length(still.lines, each) for each in (before, after)]
        assert ends[1] - ends[0] == pytest.approx(sweep, abs=1e-12)


def test_a_fine_bow_leaves_sections_of_few_control_points_without_waves():
    bow = tuple(float(3.0 * np.sin(7.0 * i)) for i in range(14))
    fine = replace(stacked.PRISM, skinning="sections", lean=bow)
    v = np.linspace(0.0, 1.0, 61)
    position, theta, sections = reference(fine, v)
    asked = MM * Span(v).values(bow) / position[:, 1] + np.radians(Span(v).values(fine.stacking.theta))
    assert theta == pytest.approx(asked, abs=1e-14)
    shapes = [section / chord for section, chord in zip(sections.plane_points(V)[0], sections.chord, strict=True)]
    offsets = (sections.start / sections.chord)[:, None]
    for shape, offset in zip(shapes, offsets, strict=True):
        assert shape - [0.0, 1.0] * offset == pytest.approx(shapes[0] - [0.0, 1.0] * offsets[0], abs=1e-13)


@pytest.mark.parametrize("design", stacked.ALL, ids=NAMES)
def test_every_new_parameter_has_an_effect_and_the_derivative_of_differences(design):
    values = design.parameters()
    own = ("stacking.", "sweep", "lean", "conformal_sweep")
    wall = next(path for path in values if path.startswith("flow_path.hub.") and path.endswith("[1].x"))
    section = next(path for path in values if path.startswith("section.") and values[path] != 0.0)
    paths = [path for path in values if path.startswith(own)] + [wall, section]
    shares = np.random.default_rng(5).uniform(0.5, 1.0, len(paths))

    def points(changes):
        stations = exact_sectioned_blade(design.changed(changes), checked=False).sections(V[1:4])
        edge = stations.trailing_edge()
        return np.concatenate([*stations.points(np.array([0.0, 0.3, 1.0])), np.stack(edge, axis=-2)], axis=-2)

    batch = np.eye(len(paths)) * 1e-30j
    rates = np.imag(points({path: values[path] + row for path, row in zip(paths, batch, strict=True)})) / 1e-30
    size = np.max(np.abs(rates[:, :, :6]), axis=(1, 2, 3))
    assert np.all(size > 0.0), [path for path, each in zip(paths, size, strict=True) if each == 0.0]
    # all at once, each by as much as moves points by a tenth of a micrometre
    steps = 1e-7 * shares / size
    found = np.tensordot(steps, rates, axes=1)
    ahead, back = (
        points({path: values[path] + sign * step for path, step in zip(paths, steps, strict=True)})
        for sign in (1.0, -1.0)
    )
    # points and derivatives at the edge by sizes of their own; rounding over the step, and its square
    scale = np.max(np.abs(found), axis=(0, 2))[:, None]
    assert np.max(np.abs((ahead - back) / 2.0 - found) / scale) < 1e-6


@pytest.mark.parametrize(
    "design",
    [pytest.param(stacked.AXIAL, marks=pytest.mark.slow), stacked.RETURN, stacked.RULED],
    ids=lambda d: d.name,
)
def test_stacked_and_ruled_solids_come_back_from_step_files(design, tmp_path):
    blade = built(design)
    assert blade.conformance.kept, blade.conformance
    trip = cad.write(blade, tmp_path / "blade.step", samples=900)
    assert trip.passed, trip.failures
    if design.skinning == "ruled":
        _check_rulings(blade, parallel=False)
        assert 30.0 < blade.conformance.twist < 90.0  # it is turned by 40 deg between hub and shroud
        assert "twist" not in blade.conformance.limits


@pytest.mark.parametrize("design", [stacked.PRISM, stacked.MILLED], ids=lambda d: d.name)
def test_a_flank_cutter_touches_developable_sides_along_whole_lines(design):
    blade = design.build()
    assert blade.conformance.kept, blade.conformance
    assert blade.conformance.twist < 1e-9  # rounding
    assert blade.conformance.flank_cut < 1e-15
    _check_rulings(blade, parallel=True)


def test_the_twist_of_a_ruled_side_and_the_cut_of_a_cylinder_on_it_are_those_of_the_paraboloid():
    # z = a x y, whose normal at (x, y) is along (-a y, -a x, 1): along x = 1 it turns by atan(a)
    a, net = 0.3, np.zeros((2, 2, 3))
    net[..., 0], net[..., 1] = np.meshgrid([0.0, 1.0], [0.0, 1.0], indexing="ij")
    net[1, 1, 2] = a
    ends = np.array([0.0, 0.0, 1.0, 1.0])
    flat, side = (
        Surface(control_points=points, knots_u=ends, knots_v=ends, degree_u=1, degree_v=1)
        for points in (net * [1.0, 1.0, 0.0], net)
    )
    found = twist_of((flat, side))
    assert (found.side, found.u) == ("lower", 0.0)
    assert found.angle == pytest.approx(np.arctan(a), rel=1e-12)
    # a cylinder along y, tilted by half the twist: the depth of its lowest point below the plane beside the line
    turn = np.linspace(-1.0, 1.0, 20001) * found.angle
    x, z = np.sin(turn), 1.0 - np.cos(turn)
    deepest = np.max(x * np.sin(found.angle / 2.0) - z * np.cos(found.angle / 2.0))
    assert found.cut == pytest.approx(deepest, rel=1e-6)


def _check_rulings(blade, *, parallel):
    u, v = np.linspace(0.02, 0.98, 25), np.linspace(0.0, 1.0, 9)
    for side in blade.sides:
        grid = side.grid(u, v)
        line = grid[:, -1:] - grid[:, :1]
        line = line / length(line)[..., None]
        off = np.cross(grid - grid[:, :1], line)
        # straight to rounding
        assert np.max(length(off)) < 1e-13 * blade.chord
        if parallel:
            normals = side.normal(u[:, None], v)
            # a flank cutter touches along whole lines: the normal keeps its direction along each
            assert np.max(length(np.cross(normals, normals[:, :1]))) < 1e-9
            forms = {o: side.grid(u, v, *o) for o in ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2))}
            across = np.cross(forms[1, 0], forms[0, 1])
            size = length(across)
            second = [np.sum(forms[o] * across, axis=-1) / size for o in ((2, 0), (1, 1), (0, 2))]
            along_u, along_v = forms[1, 0], forms[0, 1]
            pairs = (along_u, along_u), (along_u, along_v), (along_v, along_v)
            first = [np.sum(a * b, axis=-1) for a, b in pairs]
            gauss = (second[0] * second[2] - second[1] ** 2) / size**2
            mean = (first[2] * second[0] - 2.0 * first[1] * second[1] + first[0] * second[2]) / (2.0 * size**2)
            # noses are bent hundreds of times as much as the chord would be
            assert np.max(np.abs(gauss) / (mean**2 + blade.chord**-2)) < 1e-10


def test_a_developable_blade_lies_on_its_stream_surfaces_and_keeps_the_hubs_section():
    exact = exact_sectioned_blade(stacked.MILLED)
    hub, all_of_them = exact.design_sections(np.zeros(1)), exact.sections(V)
    for own, side in zip(hub.points(V), all_of_them.points(V), strict=True):
        assert side[0] == pytest.approx(own[0], abs=1e-15)
    # points by their planes are those by the lines
    for laid, side in zip(all_of_them.plane_points(V), all_of_them.points(V), strict=True):
        assert all_of_them.in_space(laid) == pytest.approx(side, abs=1e-14)


def test_ruled_blades_have_sections_where_the_design_has_them():
    ruled = exact_sectioned_blade(stacked.RULED)
    assert ruled.section_spans == (0.0, 1.0)
    assert ruled.section(1.0).edges == ("round", "blunt")
    with pytest.raises(DesignError, match=r"a section was asked at v = 0\.5 of a blade whose skinning is 'ruled'"):
        ruled.section(0.5)


TURNED = replace(
    COMPRESSOR,
    skinning="ruled",
    leading_edge_theta=0.0,
    section=replace(stacked.CONSTANT, metal_angle_in=(70.0, -60.0), metal_angle_out=(60.0, -70.0)),
)
BACK = through((10, 80), (30, 130), (10, 110), (12, 180))
OUTSIDE = replace(stacked.AXIAL.stacking, hub_x=500.0)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda: replace(COMPRESSOR, trailing_edge=None), "trailing_edge is missing beside leading_edge"),
        (lambda: replace(COMPRESSOR, leading_edge=None, trailing_edge=None), "neither edge curves nor stacking are"),
        (
            lambda: replace(stacked.BESIDE, stacking=stacked.AXIAL.stacking),
            "stacking.chord is given together with leading_edge and trailing_edge",
        ),
        (lambda: replace(stacked.AXIAL, leading_edge_theta=1.0), "leading_edge_theta is given together with stacking"),
        (lambda: stacked.stacked(COMPRESSOR, hub_x=2.0), "stacking.chord is missing"),
        (lambda: stacked.stacked(COMPRESSOR, chord=2.0), "stacking says nowhere where the reference points stand"),
        (lambda: stacked.stacked(COMPRESSOR, chord=2.0, hub_x=1.0, hub_r=2.0), "hub_x and hub_r are both given"),
        (lambda: stacked.LINE.changed("stacking.chord_fraction[1]", 1.2), r"chord_fraction\[1\] is 1.2: the reference"),
        (lambda: stacked.LINE.changed("stacking.reference", "centroid"), "reference is 'centroid' and chord_fraction"),
        (lambda: replace(stacked.RULED, lean=(0.0, 1.0, 0.0)), "lean has 3 control points, but skinning is 'ruled'"),
        (
            lambda: replace(stacked.PRISM, section=COMPRESSOR.section),
            "section.metal_angle_in has 3 control points, but skinning is 'developable', .* at the hub alone",
        ),
        (
            lambda: stacked.AXIAL.changed("stacking.chord[0]", 400.0).build(),
            r"stacking.chord: at v = 0 the section is .* there is room for .* shorten the chord",
        ),
        (lambda: replace(stacked.AXIAL, stacking=OUTSIDE).build(), "stacking.hub_x does not meet the stream line"),
        (
            lambda: stacked.RADIAL.changed("stacking.onwards", "equal-r").build(),
            "or take stacking.onwards = 'least",
        ),
        (lambda: stacked.RETURN.changed("stacking.hub_m", 900.0).build(), "stacking.hub_m is 900: the hub is 200 long"),
        (lambda: replace(stacked.AXIAL, sweep=(0.0, 200.0)).build(), "past the downstream end of the flow path"),
        (TURNED.build, "turn the blade inside out"),
        (lambda: replace(stacked.PRISM, sweep=(0.0, 300.0)).build(), "past the downstream end of the flow path"),
        (
            lambda: stacked.stacked(
                COMPRESSOR, chord=40.0, line=through((10, 80), (30, 130), (10, 110), (12, 180))
            ).build(),
            "stacking.line meets the stream line at v = .* times",
        ),
        (lambda: replace(COMPRESSOR, section_spans=(0.4, 0.3)), r"section_spans\[0\] is 0.4: span fractions"),
        (
            lambda: replace(stacked.RETURN, conformal_sweep=0.1),
            "conformal_sweep is given, but sections are laid out",
        ),
    ],
)
def test_a_place_that_cannot_be_is_refused_with_its_cause(change, message):
    with pytest.raises(DesignError, match=message):
        change()
