"""Fillets between a blade and its walls: what a rolling ball touches, tangent to both, inside what is promised."""

from dataclasses import replace
from importlib.resources import files

import numpy as np
import pytest
import random_parts

import bladewright as bw
from bladewright import cad
from bladewright.blade.design.fillet import Fillet, FilletRadii
from bladewright.blade.design.flow_path import Channel
from bladewright.blade.native.closed_section import Sites
from bladewright.blade.native.end_faces import end_row
from bladewright.blade.native.fillet_knots import levels
from bladewright.blade.native.rolling_ball import Rolled, balls_of, closed_section
from bladewright.derivatives.complex_step import stepped
from bladewright.numerics.elementary import cross, dot, length
from bladewright.numerics.quadrature import panels
from bladewright.nurbs.basis import breaks
from machines.coarse import CASCADE, CLEARED, RADIAL, ROTOR
from machines.refusals import names_the_largest_radius

STRAIGHT = replace(
    CASCADE,
    name="straight",
    leading_edge_y=0.0,
    stagger=-32.0,
    metal_angle_in=15.0,
    thickness_upper=(0.03, 0.05, 0.03, 0.02),
    tangent_out=0.4,
    channel=Channel(
        leading_edge=((0.0, 0.0), (0.0, 100.0)),
        trailing_edge=((60.0, 0.0), (60.0, 100.0)),
        hub=((20.0, 0.0), (40.0, 0.0)),
        shroud=((20.0, 100.0), (40.0, 100.0)),
    ),
)
"""A straight blade between flat walls, for closed forms."""
U = np.linspace(0.0, 1.0, 103)
SHARE = 0.015
"""radius of the fillets over the chord"""


def radius_of(design, share=SHARE):
    return share * design.build().chord / design.metre


def with_fillets(design, **fillet):
    given = fillet or {"radius": radius_of(design)}
    walls = [name for name in design.ends if name != "tip"]
    return design.changed({f"{wall}_fillet": Fillet(**given) for wall in walls})


@pytest.fixture(scope="module", params=[ROTOR, CASCADE], ids=lambda design: design.name)
def blade(request):
    return with_fillets(request.param).build()


def walls_of(blade):
    return [name for name in blade.design.ends if name != "tip"]


def touches(blade, side):
    """The balls at U on one side of the plain blade, by the wall."""
    section = closed_section(blade.plain)
    sites = Sites(side=np.full(len(U), side), u=U)
    return Rolled.at(section, balls_of(blade.plain, section, blade.design), sites).touches


def test_a_fillet_of_constant_radius_lies_on_the_ball(blade):
    for side, name in enumerate(("upper", "lower")):
        for wall, touch in touches(blade, side).items():
            radius = blade.design.metre * getattr(blade.design, f"{wall}_fillet").radius
            for v in (0.0, 0.2, 0.5, 0.9, 1.0):
                points = blade.surfaces[f"{wall}_fillet_{name}"](U, v)
                assert np.max(np.abs(length(points - touch.sections.centre) / radius - 1.0)) < 1e-6


def test_its_foot_lies_on_the_wall_and_is_tangent_there(blade):
    for side, name in enumerate(("upper", "lower")):
        for wall, touch in touches(blade, side).items():
            face, at = blade.surfaces[f"{wall}_fillet_{name}"], 0.0 if wall == "hub" else 1.0
            found, own = touch.found, touch.ball.wall
            off = dot(face(U, at) - own.point(found.t, found.across), own.normal(found.t, found.across))
            assert np.max(np.abs(off)) < 1e-7 * blade.chord
            assert np.max(length(cross(face.normal(U, at), own.normal(found.t, found.across)))) < 1e-6


def strips_of(blade):
    """By wall and side: side, strip and fillet, and v at which the strip ends towards the fillet."""
    for wall in walls_of(blade):
        for name in ("upper", "lower"):
            faces = [blade.surfaces[each] for each in (name, f"{wall}_strip_{name}", f"{wall}_fillet_{name}")]
            yield wall, *faces, float(wall == "shroud")


def test_strip_and_fillet_share_one_row_and_one_tangent_plane(blade):
    for wall, _, strip, face, low in strips_of(blade):
        row = 0 if wall == "hub" else -1
        assert np.array_equal(end_row(strip, row).control_points, end_row(face, -1 - row).control_points)
        assert np.max(length(cross(strip.normal(U, low), face.normal(U, 1.0 - low)))) < 1e-9


def test_a_strip_goes_on_as_the_side(blade):
    for _, side, strip, _, low in strips_of(blade):
        assert np.max(length(strip(U, 1.0 - low) - side(U, low))) < 1e-13
        assert np.max(length(cross(strip.normal(U, 1.0 - low), side.normal(U, low)))) < 1e-9
        # one share for the whole joint, or second derivatives along other tangents would not agree
        share = length(strip.derivative(U, 1.0 - low, 0, 1)) / length(side.derivative(U, low, 0, 1))
        assert np.ptp(share) < 1e-9 * np.mean(share)
        second = strip.derivative(U, 1.0 - low, 0, 2) - np.mean(share) ** 2 * side.derivative(U, low, 0, 2)
        assert np.max(length(second)) < 1e-9 * np.mean(share) ** 2 * blade.chord


def test_the_side_above_its_strips_is_the_plain_one_cut(blade):
    low, high = levels(blade.knots.strips)
    for own, plain in zip(blade.sides, blade.plain.sides, strict=True):
        assert np.max(length(own.grid(U, U) - plain.grid(U, low + (high - low) * U))) < 1e-14
        assert len(own.control_points[0]) <= len(plain.control_points[0])


def test_a_strip_lies_on_the_blade_without_a_fillet(blade):
    w = np.array([0.0, 0.03, 0.1, 0.3, 0.6, 0.97, 1.0])
    for side, name in enumerate(("upper", "lower")):
        for wall, touch in touches(blade, side).items():
            at = w if wall == "hub" else 1.0 - w
            strip, lines = blade.surfaces[f"{wall}_strip_{name}"], blade.knots.strips[wall]
            miss = strip.grid(U, at).swapaxes(0, 1) - touch.above(lines, w)
            assert np.max(length(miss)) < blade.tolerance * blade.chord
            # nowhere folded over
            out = touch.section.normal(*lines.places(touch.found.sites, touch.course(lines), w)).swapaxes(0, 1)
            sense = blade.orientations[name] * dot(np.cross(strip.grid(U, at, 1, 0), strip.grid(U, at, 0, 1)), out)
            assert np.min(sense) > 0.0


def test_the_foot_bounds_the_end_face(blade):
    for wall in walls_of(blade):
        end = blade.surfaces[wall]
        for flat, curve in zip(end.boundary, blade.end_outline(wall), strict=True):
            places = flat(U)
            assert np.max(length(end.surface(places[:, 0], places[:, 1]) - curve(U))) < 2e-7 * blade.chord


@pytest.mark.parametrize("design", [STRAIGHT, pytest.param(ROTOR, marks=pytest.mark.slow)], ids=lambda each: each.name)
def test_a_filleted_blade_survives_its_file(design, tmp_path):
    trip = cad.write(with_fillets(design).build(), tmp_path / "blade.step")
    assert trip.passed, str(trip)


def around_straight_blade():
    """The perimeter of the straight blade [m], and the design of a fillet on it with its radius [m]."""
    design = STRAIGHT.changed("hub_fillet", Fillet(radius=radius_of(STRAIGHT)))
    rows = [end_row(side, 0) for side in STRAIGHT.build().sides]
    places = [panels(breaks(row.knots), 12) for row in rows]
    perimeter = sum(np.sum(weight * length(row.derivative(u))) for row, (u, weight) in zip(rows, places, strict=True))
    return perimeter, design, design.metre * design.hub_fillet.radius


def test_the_fillet_of_a_straight_blade_on_a_flat_wall_has_the_volume_of_pappus():
    perimeter, design, radius = around_straight_blade()
    area, moment = (1.0 - np.pi / 4.0) * radius**2, (5.0 / 6.0 - np.pi / 4.0) * radius**3
    added = design.build().properties.volume - STRAIGHT.build().properties.volume
    assert added == pytest.approx(area * perimeter + 2.0 * np.pi * moment, rel=1e-6)


def test_the_derivative_of_that_volume_by_the_radius_is_that_of_the_closed_form():
    perimeter, design, radius = around_straight_blade()
    rate = bw.sensitivity(design, lambda built: built.properties.volume, free=["hub_fillet.radius"])
    exact = 2.0 * (1.0 - np.pi / 4.0) * radius * perimeter + 6.0 * np.pi * (5.0 / 6.0 - np.pi / 4.0) * radius**2
    assert rate["hub_fillet.radius"] == pytest.approx(exact * design.metre, rel=1e-6)


def test_an_ellipse_of_equal_axes_is_the_ball():
    radius = radius_of(ROTOR)
    ball = ROTOR.changed("hub_fillet", Fillet(radius=radius)).build()
    other = ROTOR.changed("hub_fillet", Fillet(kind="ellipse", on_blade=radius, on_wall=radius)).build(knots=ball.knots)
    for name in ("upper", "hub_strip_upper", "hub_fillet_upper", "hub_fillet_lower"):
        assert np.max(np.abs(other.surfaces[name](U, 0.4) - ball.surfaces[name](U, 0.4))) < 1e-12


def test_an_ellipse_on_a_flat_wall_has_its_axes():
    radius = radius_of(STRAIGHT)
    built = STRAIGHT.changed("hub_fillet", Fillet(kind="ellipse", on_blade=2.0 * radius, on_wall=radius)).build()
    top, foot = built.surfaces["hub_strip_upper"](0.5, 0.0), built.surfaces["hub_fillet_upper"](0.5, 0.0)
    metre = built.design.metre
    assert (top - foot)[2] == pytest.approx(2.0 * radius * metre, rel=1e-6)
    assert length((top - foot)[:2]) == pytest.approx(radius * metre, rel=1e-6)


def test_four_values_hold_at_edges_and_sides():
    least = radius_of(ROTOR)
    asked = {"leading_edge": least, "upper": 1.6 * least, "trailing_edge": 0.8 * least, "lower": 1.3 * least}
    built = ROTOR.changed("hub_fillet", Fillet(radius=FilletRadii(**asked))).build()
    section = closed_section(built.plain)
    ball = balls_of(built.plain, section, built.design)["hub"]
    sites = Sites(side=np.array([0, 0, 0, 1]), u=np.array([0.0, 0.5, 1.0, 0.5]))
    assert ball.sizes(sites)[0] == pytest.approx(built.design.metre * np.array(list(asked.values())))
    assert ball.growth(sites)[0] == pytest.approx(np.zeros(4), abs=1e-15)


def test_curvature_goes_on_across_both_joints():
    built = with_fillets(ROTOR, kind="curvature", radius=radius_of(ROTOR)).build()
    radius = built.design.metre * built.design.hub_fillet.radius
    for side, name in enumerate(("upper", "lower")):
        face, strip = built.surfaces[f"hub_fillet_{name}"], built.surfaces[f"hub_strip_{name}"]
        along = face.derivative(U, 1.0, 0, 1)
        assert np.max(np.abs(bend(face, 1.0, along) - bend(strip, 0.0, along))) < 1e-4 / radius
        touch = touches(built, side)["hub"]
        down = face.derivative(U, 0.0, 0, 1)
        wanted = touch._bend_of_wall(down) / dot(down, down)
        sense = dot(face.normal(U, 0.0), touch.sections.normals[1])
        assert np.max(np.abs(sense * bend(face, 0.0, down) - wanted)) < 1e-4 / radius


def bend(face, v, along):
    """Normal curvature of a face along tangents at (U, v)."""
    by_u, by_v = face.derivative(U, v, 1, 0), face.derivative(U, v, 0, 1)
    normal = face.normal(U, v)
    frame = np.stack([by_u, by_v, normal], axis=-1)
    first, second, _ = np.linalg.solve(frame, along[..., None])[..., 0].T
    parts = [dot(face.derivative(U, v, *order), normal) for order in ((2, 0), (1, 1), (0, 2))]
    return (parts[0] * first**2 + 2.0 * parts[1] * first * second + parts[2] * second**2) / dot(along, along)


def test_derivatives_are_those_of_differences():
    design = ROTOR.changed("hub_fillet", Fillet(radius=(radius_of(ROTOR), 1.3 * radius_of(ROTOR))))
    base = design.build()
    values = design.parameters()
    paths = ["hub_fillet.radius[1]", "leading_edge_radius", "channel.hub[1].r", "thickness_upper[2]"]
    paths = [next(path for path in values if path.startswith(name)) for name in paths]

    def quantity(built):
        points = [built.surfaces[name](0.3, 0.4) for name in ("upper", "hub_strip_upper", "hub_fillet_lower")]
        return np.concatenate([*points, built.surfaces["hub"].boundary[0].control_points[5]])

    for path, carrying in zip(paths, stepped(design, base, paths), strict=True):
        step = 1e-3 * values[path]
        moved = [
            quantity(design.changed(path, values[path] + k * step).build(knots=base.knots)) for k in (-2, -1, 1, 2)
        ]
        slope = (moved[0] - 8.0 * moved[1] + 8.0 * moved[2] - moved[3]) / (12.0 * step)
        found = np.imag(quantity(carrying)) / 1e-30
        assert np.max(np.abs(found - slope)) < 1e-7 * np.max(np.abs(slope)), path


@pytest.mark.parametrize("design", [pytest.param(ROTOR, marks=pytest.mark.slow), CLEARED], ids=lambda each: each.name)
def test_a_refusal_names_the_largest_radius_that_holds(design):
    wall = next(name for name in design.ends if name != "tip")
    asked = design.changed(f"{wall}_fillet", Fillet(radius=radius_of(design, 0.5)))
    assert names_the_largest_radius(asked, wall=wall)


@pytest.mark.parametrize(
    ("radius", "says"),
    [
        (1e9, r"hub_fillet.radius is 1e\+09 mm: .* the largest that holds is \d"),
        (1e-9, "CAD programs lose narrower faces"),
    ],
)
@pytest.mark.filterwarnings("error")
def test_a_radius_beyond_all_measure_is_refused_like_any_other(radius, says):
    with pytest.raises(bw.DesignError, match=says):
        ROTOR.changed("hub_fillet", Fillet(radius=radius)).build()


def test_a_blade_that_leans_into_its_wall_has_no_fillet():
    with pytest.raises(bw.DesignError, match=r"meet at 17\d deg, which it cannot fill; no smaller one holds either"):
        with_fillets(RADIAL).build()


def test_a_ball_rolls_around_the_round_corners_of_a_back_face():
    design = bw.read_design(files("bladewright") / "examples" / "wedge-diffuser.toml")
    built = design.changed("hub_fillet", Fillet(radius=1.0)).build()
    assert built.back is not None
    at = np.linspace(0.8, 1.0, 41)
    for name in ("upper", "lower"):
        foot, joint = (built.surfaces[f"hub_fillet_{name}"](at, v) for v in (0.0, 1.0))
        # its walls are flat and its blade stands upright
        assert length(foot[:, 1:] - joint[:, 1:]) == pytest.approx(1e-3, rel=1e-6)
        assert np.abs(foot[:, 0] - joint[:, 0]) == pytest.approx(1e-3, rel=1e-6)


def test_a_fillet_turns_at_once_where_the_curvature_of_a_side_jumps():
    plain = bw.read_design(files("bladewright") / "examples" / "exhaust-strut.toml")
    design = plain.changed("hub_fillet", Fillet(radius=0.04 * plain.build().chord / plain.metre))
    built = design.build()
    knots, counts = np.unique(built.knots.splines.knots, return_counts=True)
    kinks = knots[1:-1][counts[1:-1] == 5]
    assert kinks == pytest.approx([0.1, 0.85, 0.95])
    # it took 303 poles to round them
    assert len(built.knots.splines.knots) < 200
    v = np.linspace(0.0, 1.0, 11)
    for name in ("hub_fillet_upper", "hub_fillet_lower"):
        for u in kinks:
            before, after = (built.surfaces[name].normal(u + step, v) for step in (-1e-12, 1e-12))
            assert np.max(length(cross(before, after))) < 1e-5


@pytest.mark.slow
def test_a_fillet_that_needs_too_many_poles_names_the_largest_radius_that_does_not(monkeypatch):
    monkeypatch.setattr("bladewright.blade.native.fillet_joints.KINK", 9.0)
    monkeypatch.setattr("bladewright.blade.native.fillet_knots.MOST_POLES", (260, 60))
    plain = bw.read_design(files("bladewright") / "examples" / "exhaust-strut.toml")
    asked = plain.changed("hub_fillet", Fillet(radius=0.04 * plain.build().chord / plain.metre))
    assert names_the_largest_radius(asked, "of hub_fillet the largest that holds is")


@pytest.mark.parametrize(
    ("seed", "says"),
    [
        # an ellipse too flat for the angle of blade and wall
        (268, r"^hub_fillet.* meet at 139 deg, where an ellipse .* touches the blade past its hub;"),
        # the other fillet touches nothing
        (177, r"^hub_fillet.*; the largest that holds is 0.206\d of that$"),
    ],
)
def test_a_random_fillet_is_refused_for_what_stops_it(seed, says):
    with pytest.raises(bw.DesignError, match=says):
        random_parts.random_design(seed).build()


@pytest.mark.parametrize(("seed", "jumps"), [(169, "shroud"), pytest.param(153, "upper side", marks=pytest.mark.slow)])
def test_a_fillet_that_takes_on_a_curvature_that_jumps_is_refused_and_the_cure_holds(seed, jumps):
    design = random_parts.random_design(seed)
    with pytest.raises(bw.DesignError, match=f"the curvature of the {jumps} jumps.*take kind = .radius."):
        design.build()
    assert design.changed("shroud_fillet.kind", "radius").build().properties.volume > 0.0


@pytest.mark.parametrize(("seed", "poles"), [pytest.param(249, 270, marks=pytest.mark.slow), (372, 180)])
def test_knots_stand_where_contacts_cross_joints_of_walls_and_curvatures_bend_at_edges(seed, poles):
    """More than 300 control points were asked for."""
    fillet = random_parts.random_design(seed).build().surfaces["hub_fillet_upper"]
    assert len(fillet.control_points) < poles


def test_a_suction_side_that_is_not_known_is_refused():
    radii = FilletRadii(leading_edge=0.1, trailing_edge=0.1, suction_side=0.1, pressure_side=0.1)
    from bladewright.blade.native.fillet_sizes import side_radii

    with pytest.raises(bw.DesignError, match="give upper and lower, or rotation"):
        side_radii(radii, lambda: None)
    assert side_radii(radii, lambda: "lower") == (0.1, 0.1)
