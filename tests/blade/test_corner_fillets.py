"""Fillets of blades with corners: a ball that pivots about sharp, blunt and cut edges."""

from dataclasses import replace
from importlib.resources import files

import numpy as np
import pytest

import bladewright as bw
from bladewright import cad
from bladewright.blade.design.cut import AtX, Cut
from bladewright.blade.design.disc import Disc
from bladewright.blade.design.fillet import Fillet
from bladewright.blade.native.fillet_limits import place_named
from bladewright.blade.native.native_edges import with_native_edges
from bladewright.blade.native.pivot import pivots_of
from bladewright.blade.native.rolling_ball import Rolled, balls_of, closed_section
from bladewright.cad.closure import closure
from bladewright.cad.solids import occ_solid
from bladewright.derivatives.complex_step import stepped
from bladewright.numerics.elementary import cross, length
from machines.coarse import CASCADE, ROTOR
from machines.refusals import names_the_largest_radius

U = np.linspace(0.0, 1.0, 41)
SHARE = 0.015
"""radius of the fillets over the chord"""
SHARP = bw.read_design(files("bladewright") / "examples" / "vaned-diffuser.toml")
DESIGNS = {
    "sharp edges": (SHARP, ("hub",)),
    "a cut edge": (replace(ROTOR, cut=Cut(trailing_edge=AtX(x=60.0))), ("hub",)),
    "a cut edge in a cascade": (replace(CASCADE, cut=Cut(trailing_edge=AtX(x=50.0))), ("hub", "shroud")),
}


def filleted(name, **fillet):
    design, walls = DESIGNS[name]
    given = fillet or {"radius": SHARE * design.build().chord / design.metre}
    return design.changed({f"{wall}_fillet": Fillet(**given) for wall in walls})


@pytest.fixture(
    scope="module",
    params=["sharp edges", "a cut edge in a cascade", pytest.param("a cut edge", marks=pytest.mark.slow)],
)
def blade(request):
    return filleted(request.param).build()


def touches(blade):
    whole = with_native_edges(blade.before)
    section = closed_section(whole)
    return Rolled.at(section, balls_of(whole, section, blade.design), blade.knots.splines.sites).touches


def pivots(blade):
    """Wall, ball's radius, pivot and its face."""
    for wall, touch in touches(blade).items():
        radius = blade.design.metre * getattr(blade.design, f"{wall}_fillet").radius
        for pivot in pivots_of(touch):
            yield wall, radius, pivot, blade.surfaces[f"{wall}_fillet_{pivot.name}"]


def test_a_fillet_about_a_corner_lies_on_balls_that_touch_corner_and_wall(blade):
    found = 0
    for _, radius, pivot, face in pivots(blade):
        ball, wall = pivot.at(U), pivot.touch.ball.wall
        centre = ball.sections.centre
        # the witness: the ball's distance from the wall and from the corner's line, not how it was found
        t, across = wall.places_below(centre)
        assert length(centre - wall.point(t, across)) == pytest.approx(radius, rel=1e-9)
        assert length(centre - ball.sections.blade) == pytest.approx(radius, rel=1e-9)
        for v in (0.0, 0.2, 0.5, 0.9, 1.0):
            assert np.max(np.abs(length(face(U, v) - centre) / radius - 1.0)) < 1e-6
        found += 1
    assert found >= 2


def test_its_foot_lies_on_the_wall_and_is_tangent_there(blade):
    for wall, _, pivot, face in pivots(blade):
        at, own = 0.0 if wall == "hub" else 1.0, pivot.touch.ball.wall
        foot = face(U, at)
        t, across = own.places_below(foot)
        assert np.max(length(foot - own.point(t, across))) < 1e-7 * blade.chord
        assert np.max(length(cross(face.normal(U, at), own.normal(t, across)))) < 1e-6


def test_it_shares_columns_and_tangent_planes_with_the_fillets_beside_it(blade):
    for wall, _, pivot, face in pivots(blade):
        names = ("upper", "lower", "leading_edge", "trailing_edge")
        for (side, u), own, there in ((pivot.corner.first, 0, pivot.first), (pivot.corner.second, -1, pivot.last)):
            if not there:
                continue
            other = blade.surfaces[f"{wall}_fillet_{names[side]}"]
            column = other.control_points[-1 if u else 0]
            inner = slice(0, -1) if wall == "hub" else slice(1, None)
            assert np.array_equal(face.control_points[own][inner], column[inner])
            v = np.linspace(0.1, 0.8, 15) if wall == "hub" else np.linspace(0.2, 0.9, 15)
            planes = face.normal(-float(own), v), other.normal(u, v)
            assert np.max(length(cross(*planes))) < 5e-6


def test_strips_reach_the_corners_line_and_keep_the_tangent_plane_of_the_fillet(blade):
    for wall, touch in touches(blade).items():
        low = 0.0 if wall == "hub" else 1.0
        for name in ("upper", "lower", "trailing_edge"):
            if f"{wall}_strip_{name}" not in blade.surfaces:
                continue
            strip, fillet = (blade.surfaces[f"{wall}_{part}_{name}"] for part in ("strip", "fillet"))
            # away from the pole, where a fillet has no normal
            u = np.linspace(0.01, 0.99, 99)
            assert np.max(length(cross(strip.normal(u, low), fillet.normal(u, 1.0 - low)))) < 2e-9
        for corner in touch.section.corners:
            strip = blade.surfaces[
                f"{wall}_strip_{('upper', 'lower', 'leading_edge', 'trailing_edge')[corner.first[0]]}"
            ]
            edge = strip(corner.first[1], U)
            contact = float(touch.corners.v[2 * list(touch.section.corners).index(corner)])
            level = blade.knots.strips[wall].level
            along = U if wall == "hub" else 1.0 - U
            line = touch.section.faces[corner.first[0]](corner.first[1], contact + (level - contact) * along)
            assert np.max(length(edge - line)) < 1e-13


def test_a_blade_with_filleted_corners_is_one_closed_valid_solid(blade):
    closed = closure(occ_solid(blade).solid)
    assert (closed.solids, closed.free_edges, closed.non_manifold_edges) == (1, 0, 0)
    assert closed.valid


@pytest.mark.slow
def test_passage_and_wheel_stand_around_filleted_corners():
    design, _ = DESIGNS["a cut edge"]
    radius = SHARE * design.build().chord / design.metre
    built = replace(design, hub_fillet=Fillet(radius=radius), disc=Disc(thickness=2.0)).build()
    for body in (bw.passage(built), bw.wheel(built)):
        closed = closure(occ_solid(body).solid)
        assert (closed.solids, closed.free_edges, closed.non_manifold_edges) == (1, 0, 0)
        assert closed.valid


@pytest.mark.parametrize("kind", ["ellipse", pytest.param("curvature", marks=pytest.mark.slow)])
def test_the_other_kinds_go_around_corners_too(kind):
    radius = SHARE * SHARP.build().chord / SHARP.metre
    sizes = {"on_blade": 1.5 * radius, "on_wall": radius} if kind == "ellipse" else {"radius": radius}
    built = filleted("sharp edges", kind=kind, **sizes).build()
    assert closure(occ_solid(built).solid).valid
    for pivot in pivots_of(touches(built)["hub"]):
        face, wall = built.surfaces[f"hub_fillet_{pivot.name}"], pivot.touch.ball.wall
        normal = wall.normal(*wall.places_below(face(U, 0.0)))
        assert np.max(length(cross(face.normal(U, 0.0), normal))) < 1e-6


@pytest.mark.slow
@pytest.mark.parametrize("name", DESIGNS)
def test_it_survives_its_file(name, tmp_path):
    trip = cad.write(filleted(name).build(), tmp_path / "blade.step")
    assert trip.passed, str(trip)


def test_derivatives_are_those_of_differences():
    design = filleted("sharp edges")
    base, values = design.build(), design.parameters()
    paths = ["hub_fillet.radius", next(path for path in values if "thickness" in path)]

    def quantity(built):
        names = ("hub_strip_upper", "hub_fillet_lower", "hub_fillet_trailing_edge")
        return np.concatenate([built.surfaces[name](0.7, 0.4) for name in names])

    for path, carrying in zip(paths, stepped(design, base, paths), strict=True):
        step = 1e-3 * values[path]
        moved = [
            quantity(design.changed(path, values[path] + k * step).build(knots=base.knots)) for k in (-2, -1, 1, 2)
        ]
        slope = (moved[0] - 8.0 * moved[1] + 8.0 * moved[2] - moved[3]) / (12.0 * step)
        found = np.imag(quantity(carrying)) / 1e-30
        assert np.max(np.abs(found - slope)) < 1e-6 * np.max(np.abs(slope)), path


def test_many_steps_at_once_are_those_of_single_builds():
    design = filleted("a cut edge in a cascade")
    base, values = design.build(), design.parameters()
    paths = ["hub_fillet.radius", "cut.trailing_edge.x", next(path for path in values if "stagger" in path)]
    for path, many in zip(paths, stepped(design, base, paths), strict=True):
        single = design.changed(path, values[path] + 1e-30j).build(knots=base.knots)
        for name in (name for name in base.surfaces if name not in design.ends):
            found, wanted = (np.imag(blade.surfaces[name].control_points) for blade in (many, single))
            assert np.max(np.abs(found - wanted)) <= 1e-9 * np.max(np.abs(wanted)), (path, name)


def test_points_for_solvers_lie_on_fillets_about_corners_too(blade):
    names = set(bw.surface_points(blade, along=3, across=3).names)
    assert {name for name in blade.surfaces if "_fillet_" in name or "_strip_" in name} <= names


def test_a_refusal_names_the_largest_radius_that_holds():
    asked = filleted("sharp edges", radius=0.4 * SHARP.build().chord / SHARP.metre)
    assert names_the_largest_radius(asked)


@pytest.mark.parametrize(
    ("pivot", "says"),
    [
        ("leading_edge_run", "at the leading edge"),
        ("trailing_edge_lower_run", "at the lower corner of the trailing edge"),
        ("trailing_edge_upper", "at the upper corner of the trailing edge"),
        ("lower", "at u = 0.250 of the lower side"),
    ],
)
def test_a_refusal_names_a_place_as_an_engineer_does(pivot, says):
    assert place_named(pivot, 0.25) == says
