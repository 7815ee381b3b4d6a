"""Passages around blades from sections: what the others keep, and the strips of the walls past blunt edges."""

import numpy as np
import pytest

from bladewright.blade.design.flow_path import FlowPath
from bladewright.domain.build import passage
from bladewright.domain.extents import USUAL
from bladewright.domain.knots import BLADE_AT
from bladewright.domain.walls import STRIPS
from bladewright.nurbs.closest import closest_on_curve
from machines import COARSE, example
from machines.flow_paths import through
from machines.passages import SECTIONED, passage_case


def made(name):
    return passage_case(name).passage


@pytest.fixture(params=list(SECTIONED))
def around(request):
    return made(request.param)


def net(made, name):
    return made.surfaces[name].control_points


def test_passage_and_blade_fill_the_ring_and_no_patch_folds(around):
    assert abs(around.ring_error) < 1e-8
    assert around.properties.openness < 1e-13
    assert min(share for share, _, _ in around.folds.values()) > 0.01


def test_walls_lie_on_the_flow_paths_own_and_their_straight_continuations(around):
    random = np.random.default_rng(3)
    for name in (*around.walls, *around.strips):
        meridian = around.duct.wall(name.split("_")[0])
        points = around.surfaces[name](random.random(200), random.random(200))
        radius = np.hypot(points[:, 1], points[:, 2]) if around.duct.revolved else points[:, 2]
        distance = closest_on_curve(meridian, np.stack([points[:, 0], radius], axis=-1)).distances
        assert np.max(distance) < 1e-7 * around.blade.chord


def test_the_ducts_walls_are_those_of_the_flow_path_as_far_as_it_reaches(around):
    surfaces = around.blade.exact.surfaces
    low, high = max(around.knots.low, surfaces.low), min(around.knots.high, surfaces.high)
    for row, wall in enumerate(("hub", "shroud")):
        points = surfaces.position(np.array([float(row)]), np.linspace(low, high, 31)[None])[0]
        assert np.max(closest_on_curve(around.duct.wall(wall), points).distances) < 1e-10 * around.blade.chord


@pytest.mark.parametrize("name", ["axial rotor", "wedge diffuser"])
def test_without_extents_a_passage_reaches_from_end_to_end_of_the_flow_path(name):
    around = made(name)
    surfaces = around.blade.exact.surfaces
    assert (around.knots.low, around.knots.high) == surfaces.extent
    for wall in ("hub", "shroud"):
        ends = around.duct.wall(wall)(np.array([0.0, 1.0]))
        np.testing.assert_allclose(ends, surfaces.wall(wall).values(np.array([0.0, 1.0])), atol=1e-14)


def test_a_flow_path_that_ends_before_the_blade_and_its_pitch_allow_is_continued():
    near = FlowPath(hub=through((-0.4, 95), (90, 102)), shroud=through((0.8, 169), (90, 163)))
    blade = example("core-rotor").changed({"flow_path": near, "tolerance": COARSE}).build()
    around = passage(blade)
    assert around.knots.upstream == USUAL
    assert around.knots.low < blade.exact.surfaces.low
    assert around.knots.high == blade.exact.surfaces.high


def test_extents_are_mean_meridional_lengths_past_the_edges(around):
    """By lengths of chords along nine stream lines.

    Past the flow path those between walls that diverge by 3 deg are shorter than the walls by up to 1 - cos 1.5 deg.
    """
    lines = around.blade.exact.survey.lines
    duct = around.duct.lines(lines.v)
    knots = around.knots
    ends = ((lines.leading, knots.low, knots.upstream), (lines.trailing, knots.high, knots.downstream))
    for edge, end, extent in ends:
        u = edge[:, None] + (end - edge)[:, None] * np.linspace(0.0, 1.0, 2001)
        lengths = np.sum(np.sqrt(np.sum(np.diff(duct.position(u), axis=-2) ** 2, axis=-1)), axis=-1)
        assert np.mean(lengths) == pytest.approx(extent * np.mean(lines.lengths), rel=3.5e-4)


def test_halves_strips_faces_and_outlet_share_their_boundary_control_points(around):
    for past, end in enumerate(("inlet", "outlet")):
        for wall, row in (("hub", 0), ("shroud", -1)):
            chain = [net(around, f"{wall}_lower")[-past, ::-1], net(around, f"{wall}_upper")[-past]]
            strip = f"{wall}_{STRIPS[past]}"
            assert (strip in around.surfaces) == around.knots.blunt[past]
            if around.knots.blunt[past]:
                middle = net(around, strip)
                chain.insert(1, middle[-past])
                count = middle.shape[0]
                part = slice(-count, None) if past else slice(count)
                for column, half in ((0, "lower"), (-1, "upper")):
                    assert np.array_equal(middle[:, column], net(around, f"{wall}_{half}")[part, 0])
            whole = np.concatenate([chain[0], *(each[1:] for each in chain[1:])])
            assert np.array_equal(net(around, end)[:, row], whole)


def test_a_strip_starts_at_the_face_of_the_edge():
    around = made("plate with faces at both edges")
    for past, edge in enumerate(("leading_edge", "trailing_edge")):
        for wall, row in (("hub", 0), ("shroud", -1)):
            strip = net(around, f"{wall}_{STRIPS[past]}")
            assert np.array_equal(strip[past - 1], net(around, f"blade_{edge}")[::-1, row])


def test_the_wake_of_a_back_face_starts_at_both_sides_from_there_on():
    around = made("wedge diffuser")
    assert "blade_trailing_edge" not in around.surfaces
    count = len(around.knots.tail) - 6
    for wall, row in (("hub", 0), ("shroud", -1)):
        lower, upper = (net(around, f"blade_{half}")[-count:, row] for half in ("lower", "upper"))
        assert np.array_equal(net(around, f"{wall}_wake")[0], np.concatenate([lower, upper[-2::-1]]))


def test_a_ruled_vane_with_a_back_face_has_its_wake_too():
    design = example("wedge-diffuser").changed({"skinning": "ruled", "tolerance": COARSE})
    around = passage(design.build())
    assert {"hub_wake", "shroud_wake"} <= set(around.surfaces)
    assert abs(around.ring_error) < 1e-8
    assert min(share for share, _, _ in around.folds.values()) > 0.01


def test_split_faces_have_one_piece_more_where_a_strip_lies_between():
    asked = SECTIONED["plate with faces at both edges"][1]
    whole = made("plate with faces at both edges")
    pieces = passage(whole.blade, knots=whole.knots, outlet_angle=asked["outlet_angle"], split=True)
    assert {"inlet_stagnation", "outlet_wake", "hub_wake", "blade_leading_edge"} <= set(pieces.surfaces)
    assert set(pieces.orientations) == set(pieces.surfaces)
    assert pieces.properties.volume == pytest.approx(whole.properties.volume, rel=1e-13)


def test_the_periodic_boundary_leaves_a_round_edge_as_its_nose_points():
    around = made("axial rotor")
    sections = around.blade.exact.sections(np.array([0.0, 1.0]))
    outline, stagger = sections.outline, sections.stagger
    for u, edge in ((BLADE_AT[0] - 1e-9, outline.leading_edge), (BLADE_AT[1] + 1e-9, outline.trailing_edge)):
        nose = edge.upper.first
        wanted = np.degrees(np.arctan(-nose[..., 0] / nose[..., 1]) + stagger)
        for row in (0, 1):
            face = around.surfaces["periodic_upper"]
            point, slope = face(u, float(row)), face.derivative(u, float(row))
            radius = np.hypot(point[1], point[2])
            radial = (point[1] * slope[1] + point[2] * slope[2]) / radius
            swirl = (point[2] * slope[1] - point[1] * slope[2]) / radius
            # the interpolant's slope is one order less accurate than its place
            assert np.degrees(np.arctan2(swirl, np.hypot(slope[0], radial))) == pytest.approx(wanted[row], abs=2e-3)


@pytest.mark.parametrize(
    ("name", "path"),
    [
        ("plate with faces at both edges", "leading_edge.points[1].x"),
        ("vanes with sharp edges", "flow_path.hub.points[1].r"),
    ],
)
def test_volume_and_poles_follow_the_parameters(name, path):
    around, asked = made(name), {key: value for key, value in SECTIONED[name][1].items() if "angle" in key}
    design = around.blade.design
    value = design.parameters()[path]

    def found(changed):
        again = passage(design.changed(path, changed).build(knots=around.blade.knots), knots=around.knots, **asked)
        poles = [net(again, name).ravel() / around.blade.chord for name in ("hub_upper", "outlet")]
        return np.concatenate([*poles, np.atleast_1d(again.properties.volume / around.blade.chord**3)])

    exact = np.imag(found(value + 1e-30j)) / 1e-30
    step = 1e-3 * max(1.0, abs(value))

    def difference(h):
        return (found(value + h) - found(value - h)) / (2.0 * h)

    # Richardson's step leaves an error of the fourth power of the step, and rounding over it
    richardson = (4.0 * difference(step / 2.0) - difference(step)) / 3.0
    np.testing.assert_allclose(richardson, exact, rtol=0, atol=1e-6 * np.max(np.abs(exact)))
    assert np.max(np.abs(exact)) > 0.0
