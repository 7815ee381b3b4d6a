"""Blades cut at hub, tip, leading and trailing edge: what is left is the uncut blade up to the surfaces that cut it."""

import numpy as np
import pytest

import bladewright as bw
from bladewright import cad
from bladewright.blade.design.cut import AtRadius, AtX, Cut
from bladewright.blade.design.fillet import Fillet
from bladewright.blade.design.meridional_curve import ThroughPoints
from bladewright.blade.native.cut_faces import face_inside
from bladewright.errors import DesignError
from bladewright.nurbs.domain import reversed as run_back
from bladewright.nurbs.fit import interpolated
from bladewright.nurbs.revolution import segment
from machines import COARSE, built, coarse, example, stacked
from machines.sectioned import COMPRESSOR, DIFFUSER, IMPELLER, PLATE, STATOR, VANE

DESIGNS = {
    "unified": coarse.ROTOR,
    "unified with a clearance": coarse.CLEARED,
    "unified in a cascade": coarse.CASCADE,
    "radial": coarse.RADIAL,
    "meanline": COMPRESSOR,
    "camber angle": IMPELLER,
    "suction and pressure side": STATOR,
    "wedge with a back face": DIFFUSER,
    "profile in a cascade": VANE,
    "blunt edges": PLATE,
    "ruled": stacked.RULED,
    "developable": stacked.MILLED,
}
OTHER = {"trailing_edge": "leading_edge", "tip": "hub"}


def design_of(name):
    return DESIGNS[name].changed("tolerance", COARSE)


def meridional(design, points):
    """(x, r), or (x, z) in a cascade, of points in space."""
    x, y, z = np.moveaxis(points, -1, 0)
    return np.stack([x, np.hypot(y, z) if design.arrangement == "annular" else z], axis=-1)


def through_blade(design, name):
    """A cut from hub to tip, or along the flow, through the middle of the blade, and past it at both ends."""
    side = built(design).surfaces["upper"]
    share = np.array([0.0, 0.35, 0.65, 1.0])
    u, v = (0.6 - 0.05 * share, share) if name.endswith("edge") else (share, 0.55 + 0.0 * share)
    on = meridional(design, side(u, v)) / design.metre
    ends = on[0] - 0.4 * (on[1] - on[0]), on[-1] + 0.4 * (on[-1] - on[-2])
    return ThroughPoints(points=tuple(tuple(map(float, point)) for point in (ends[0], *on, ends[1])))


def cut(design, **cuts):
    return design.changed("cut", Cut(**cuts))


def off_line(line, points):
    """Distances of points (..., 2) from a curve, in its unit, to one side of it."""
    curve, t = line.line(1.0).curve(), np.linspace(0.0, 1.0, 2001)
    near = t[np.argmin(np.sum((points[..., None, :] - curve(t)) ** 2, axis=-1), axis=-1)]
    for _ in range(4):
        miss, slope, bend = points - curve(near), curve.derivative(near), curve.derivative(near, 2)
        near = near + np.sum(miss * slope, axis=-1) / np.sum(slope * slope - miss * bend, axis=-1)
    miss, slope = points - curve(near), curve.derivative(near)
    return (slope[..., 0] * miss[..., 1] - slope[..., 1] * miss[..., 0]) / np.linalg.norm(slope, axis=-1)


FAST = ("unified", "blunt edges")
EVERY = [pytest.param(name, marks=() if name in FAST else pytest.mark.slow) for name in DESIGNS]


@pytest.mark.parametrize("kept", list(OTHER))
@pytest.mark.parametrize("name", EVERY)
def test_both_parts_of_a_blade_that_is_cut_through_make_the_whole(name, kept):
    design = design_of(name)
    if kept == "tip" and "tip" in design.ends:
        design = design.changed({"tip_clearance": None, "hub_clearance": None})
    whole, line = built(design), through_blade(design, kept)
    parts = [built(cut(design, **{edge: line})) for edge in (kept, OTHER[kept])]
    volume = sum(part.properties.volume for part in parts)
    allowed = design.tolerance * whole.chord * whole.properties.area
    assert volume == pytest.approx(whole.properties.volume, abs=0.1 * allowed)
    for part in parts:
        assert part.plain.surfaces.keys() == whole.surfaces.keys()


@pytest.mark.parametrize("name", EVERY)
def test_cut_edges_and_ends_lie_on_what_cuts_them(name):
    design = design_of(name)
    if "tip" in design.ends:
        design = design.changed({"tip_clearance": None, "hub_clearance": None})
    edge, end = through_blade(design, "trailing_edge"), through_blade(design, "hub")
    blade = built(cut(design, trailing_edge=edge, hub=end))
    at = np.linspace(0.0, 1.0, 101)
    for side in blade.sides:
        points = meridional(design, side(1.0, at)) / design.metre
        assert np.max(np.abs(off_line(edge, points))) < 1e-8 * blade.chord / design.metre
        points = meridional(design, side(at, 0.0)) / design.metre
        assert np.max(np.abs(off_line(end, points))) < 1e-7 * blade.chord / design.metre
    for face, line in (("trailing_edge", edge), ("hub", end)):
        trimmed = blade.surfaces[face]
        points = meridional(design, trimmed(*trimmed.interior_points(20))) / design.metre
        assert np.max(np.abs(off_line(line, points))) < 1e-12 * blade.chord / design.metre


@pytest.mark.parametrize("name", ["unified", "profile in a cascade", "blunt edges"])
def test_the_outline_of_an_end_is_closed_and_runs_through_arcs_at_cut_edges(name):
    design = design_of(name)
    blade = built(cut(design, trailing_edge=through_blade(design, "trailing_edge")))
    assert len(blade.edges) == 2
    for end in design.ends:
        chain = blade.end_outline(end)
        assert len(chain) == len(blade.surfaces[end].boundary)
        for before, after in zip(chain, (*chain[1:], chain[0]), strict=True):
            assert np.array_equal(before.control_points[-1], after.control_points[0])
    for arc in blade.edges:
        x, r = meridional(design, arc(np.linspace(0.0, 1.0, 9))).T
        assert max(np.ptp(x), np.ptp(r)) < 2e-7 * blade.chord


@pytest.mark.slow
def test_ruled_sides_stay_ruled():
    design = design_of("ruled")
    blade = built(cut(design, tip=through_blade(design, "tip")))
    u, v = np.linspace(0.0, 1.0, 21)[:, None], np.linspace(0.0, 1.0, 9)
    for side in blade.sides:
        straight = side(u, 0.0) * (1.0 - v[:, None]) + side(u, 1.0) * v[:, None]
        assert np.max(np.abs(side(u, v) - straight)) < 1e-12


def test_a_cut_tip_without_a_clearance_is_the_shroud_and_takes_a_fillet_and_with_one_it_does_not():
    line = through_blade(coarse.ROTOR, "tip")
    fillet = Fillet(radius=1.0)
    blade = cut(coarse.ROTOR, tip=line).changed("shroud_fillet", fillet).build()
    assert blade.design.ends == ("hub", "shroud")
    assert "shroud_fillet_upper" in blade.surfaces
    with pytest.raises(DesignError, match="clearance"):
        cut(coarse.CLEARED, tip=line).changed("shroud_fillet", fillet)


def test_a_clearance_at_a_cut_end_counts_from_the_cut():
    design = coarse.CLEARED.changed("tip_clearance", (2.0, 1.0))
    line = through_blade(design, "tip")
    blade = built(cut(design, tip=line))
    assert blade.plain.design.ends == ("hub", "shroud")
    assert "tip" in blade.surfaces
    off = [off_line(line, meridional(design, side(np.array([0.0, 0.5, 1.0]), 1.0)) / 1e-3) for side in blade.sides]
    assert np.abs(off[0][[0, 2]]) == pytest.approx([2.0, 1.0], abs=0.05)
    assert 1.0 < abs(off[0][1]) < 2.0
    wall = blade.end_wall("shroud")[0]
    assert np.max(np.abs(off_line(line, wall(np.linspace(0.05, 0.95, 21)) / 1e-3))) < 1e-9


def test_a_cut_keeps_the_laws_of_the_uncut_blade():
    design = design_of("unified")
    blade, whole = built(cut(design, trailing_edge=through_blade(design, "trailing_edge"))), built(design)
    assert blade.report().to_dict() == whole.report().to_dict()
    assert blade.conformance == whole.conformance
    assert blade.chord == whole.chord


def test_held_knots_build_the_same_blade():
    design = cut(design_of("unified"), trailing_edge=through_blade(design_of("unified"), "trailing_edge"))
    blade = built(design)
    again = design.build(knots=blade.knots)
    for name in ("upper", "lower"):
        assert np.array_equal(again.surfaces[name].control_points, blade.surfaces[name].control_points)


def test_an_impeller_is_trimmed_on_a_lathe():
    design = example("centrifugal-impeller")
    blade = built(cut(design, trailing_edge=AtRadius(radius=93.0)))
    points = np.stack([side(1.0, np.linspace(0.0, 1.0, 1001)) for side in blade.sides])
    assert np.max(np.abs(np.hypot(points[..., 1], points[..., 2]) / 1e-3 - 93.0)) < 2e-7
    assert blade.surfaces["trailing_edge"].revolution.meridian.degree == 1


DERIVED = {
    "an edge": (coarse.ROTOR, {"trailing_edge": AtX(x=68.0)}, ["cut*", "stagger[1]"]),
    "an end with its clearance": (
        coarse.CLEARED,
        {"tip": ThroughPoints(points=((-10.0, 228.0), (40.0, 226.0), (100.0, 222.0)))},
        ["cut.tip.points[1].r", "tip_clearance[0]"],
    ),
    "two edges and both ends": (
        coarse.CASCADE,
        {
            "leading_edge": AtX(x=4.0),
            "trailing_edge": AtX(x=36.0),
            "hub": AtRadius(radius=10.0),
            "tip": AtRadius(radius=70.0),
        },
        ["cut.leading_edge*", "cut.tip*"],
    ),
}


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.slow] if name == "an edge" else []) for name in DERIVED]
)
def test_derivatives_are_those_of_differences(name):
    design, cuts, free = DERIVED[name]
    design = cut(design, **cuts)
    blade = built(design)

    def poles(body):
        return np.concatenate([side.control_points.ravel() for side in body.sides])

    values, step = design.parameters(), 2e-3
    for path, rate in bw.sensitivity(design, poles, free=free, knots=blade.knots).items():
        nets = [poles(design.changed(path, values[path] + k * step).build(knots=blade.knots)) for k in (-2, -1, 1, 2)]
        difference = (nets[0] - 8.0 * nets[1] + 8.0 * nets[2] - nets[3]) / (12.0 * step)
        assert np.linalg.norm(rate) > 0.0
        assert np.linalg.norm(difference - rate) < 1e-7 * np.linalg.norm(rate), path


def test_the_volume_falls_with_the_face_of_a_trim():
    """The derivative of the volume by the radius of a cylinder is the area of the face on it."""
    design = cut(coarse.RADIAL, trailing_edge=AtRadius(radius=66.0))
    blade = built(design)
    rate = bw.sensitivity(design, lambda body: body.properties.volume, free="cut*")["cut.trailing_edge.radius"]
    area = blade.surfaces["trailing_edge"].area()
    assert rate == pytest.approx(area * 1e-3, rel=1e-4)


def test_a_face_may_wind_by_more_than_half_a_turn():
    """Two helices on a cylinder from theta = 0 to 4 rad, around a strip of known area."""
    t = np.linspace(0.0, 1.0, 41)
    sides = []
    for sign in (-1.0, 1.0):
        theta = 4.0 * t + 0.1 * sign * np.sin(np.pi * t)
        sides.append(interpolated(np.stack([t, np.sin(theta), np.cos(theta)], axis=-1), t, degree=5))
    wall = segment((-0.5, 1.0), (1.5, 1.0))
    face = face_inside((sides[0], run_back(sides[1])), wall, np.zeros(0), revolved=True, chord=1.0)
    assert face.area() == pytest.approx(0.4 / np.pi, rel=1e-6)
    assert face.revolution.end - face.revolution.start < 4.5


REFUSED = {
    "radius outside": ({"trailing_edge": AtRadius(radius=400.0)}, r"cut.trailing_edge.radius is 400 mm: it misses"),
    "x before": ({"trailing_edge": AtX(x=-50.0)}, r"cut.trailing_edge.x must lie between \S+ and \S+ mm"),
    "part": (
        {"leading_edge": ThroughPoints(points=((40.0, 80.0), (120.0, 200.0)))},
        r"cut.leading_edge: it misses the blade from v = ",
    ),
    "crossing": ({"leading_edge": AtX(x=50.0), "trailing_edge": AtX(x=45.0)}, r"the cuts cross, or leave"),
    "through the axis": (
        {"leading_edge": ThroughPoints(points=((5.0, -20.0), (5.0, 300.0)))},
        r"cut.leading_edge: its curve reaches down to r = -20 mm",
    ),
    "nothing": (
        {"hub": ThroughPoints(points=((-50, 150), (150, 200))), "tip": ThroughPoints(points=((-50, 149), (150, 199)))},
        r"cut.hub and cut.tip: the cuts cross",
    ),
}


@pytest.mark.parametrize("name", list(REFUSED))
def test_a_cut_that_is_none_is_refused_with_its_limit(name):
    cuts, words = REFUSED[name]
    with pytest.raises(DesignError, match=words) as caught:
        cut(coarse.ROTOR, **cuts).build()
    assert "\n" not in str(caught.value)


def test_a_cut_through_a_back_face_is_refused():
    design = design_of("wedge with a back face")
    blade = built(design)
    at = blade.exact.survey.back
    points = meridional(design, blade.surfaces["upper"]((1.0 + at) / 2.0, np.array([-0.2, 1.2]))) / design.metre
    line = ThroughPoints(points=tuple(tuple(map(float, point)) for point in points))
    with pytest.raises(DesignError, match="which is blunt already"):
        cut(design, trailing_edge=line).build()


@pytest.mark.parametrize("name", [pytest.param(each, marks=pytest.mark.slow) for each in DESIGNS])
def test_a_cut_blade_of_every_family_survives_its_files(name, tmp_path):
    design = design_of(name)
    edge = through_blade(design, "trailing_edge")
    ends = {} if "tip" in design.ends else {"hub": through_blade(design, "hub")}
    blade = built(cut(design, trailing_edge=edge, **ends))
    for ending in ("step", "igs"):
        trip = cad.write(blade, tmp_path / f"cut.{ending}", samples=400)
        assert trip.passed, trip.failures


def test_a_cylinder_may_be_crossed_against_the_sense_of_the_edge():
    """Along the cylinder the outlet of a radial turbine runs from shroud to hub, and its cut from hub to shroud."""
    design = example("radial-turbine").changed("tolerance", COARSE)
    blade = built(cut(design, trailing_edge=AtRadius(radius=50.0)))
    assert 0.0 < blade.properties.volume < built(design).properties.volume
