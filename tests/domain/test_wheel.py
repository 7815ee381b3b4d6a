"""Sectors and wheels: closed, of the volume that closed forms give, refused where they cannot be."""

import re
from dataclasses import replace

import numpy as np
import pytest

from bladewright.blade.design.cut import AtRadius, AtX, Cut
from bladewright.blade.design.disc import Disc, Outline
from bladewright.blade.design.fillet import Fillet
from bladewright.domain.build import passage
from bladewright.domain.disc import lines_and_arcs
from bladewright.domain.duct import annulus_volume
from bladewright.domain.passage_spec import PassageSpec
from bladewright.domain.sector import sector
from bladewright.domain.wheel import wheel
from bladewright.errors import DesignError
from machines import coarse

WEB = ((-8.0, 94.0), (-8.0, 60.0), (10.0, 30.0), (80.0, 30.0), (97.0, 60.0), (97.0, 118.5))
"""outline of a disc whose ends lie 0.3 and 0.2 mm off the hub"""
RADII = (3.0, 5.0, 5.0, 3.0)


def outlined(*points, radii=()):
    return Disc(outline=Outline(points=points, radii=radii))


def with_parts(design, **parts):
    return replace(design, **parts).build()


@pytest.fixture(scope="module")
def rotor():
    return with_parts(coarse.ROTOR, disc=outlined(*WEB, radii=RADII))


@pytest.fixture(scope="module")
def shrouded():
    """An impeller between a back plate and a thin cover."""
    back = outlined((-5.0, 15.7), (-5.0, 6.0), (44.0, 6.0), (44.0, 74.0), (38.0, 74.0))
    return with_parts(coarse.RADIAL, disc=back, shroud_ring=Disc(thickness=2.0))


@pytest.fixture(scope="module")
def bodies(rotor, shrouded):
    """Sector and wheel of each."""
    return {"rotor": (sector(rotor), wheel(rotor)), "shrouded": (sector(shrouded), wheel(shrouded))}


def test_arcs_are_exact_and_enclose_what_pappus_says():
    points = np.array([[0.0, 5.0], [0.0, 2.0], [4.0, 2.0], [4.0, 5.0]])
    radii = np.array([0.5, 1.0])
    pieces = lines_and_arcs(points, radii, "disc.outline", 1.0)
    assert [piece.turn is None for piece in pieces] == [True, False, True, False, True]
    t = np.linspace(0.0, 1.0, 33)
    for piece, radius, centre in zip(pieces[1::2], radii, ((0.5, 2.5), (3.0, 3.0)), strict=True):
        for line in (piece.curve(t), piece.at(t)):
            np.testing.assert_allclose(np.hypot(*(line - centre).T), radius, rtol=1e-15)
        np.testing.assert_allclose(piece.at(t[[0, -1]]), piece.curve(t[[0, -1]]), atol=1e-15)
        assert piece.length == pytest.approx(0.5 * np.pi * radius, rel=1e-14)
    assert sum(piece.length for piece in pieces) == pytest.approx(10.0 - 3.0 + 0.75 * np.pi, rel=1e-14)


@pytest.mark.parametrize("name", ["rotor", "shrouded"])
def test_a_wheel_is_its_sectors_and_both_are_the_ring_and_the_blades(name, bodies):
    one, all_ = bodies[name]
    blade = one.blade
    count = blade.design.blade_count
    volume = count * blade.properties.volume + sum(pitch.carrier.volume for pitch in all_.pitches)
    assert all_.properties.volume == pytest.approx(count * one.properties.volume, rel=1e-9)
    assert all_.properties.volume == pytest.approx(volume, rel=1e-7)
    for body in (one, all_):
        assert body.properties.openness < 1e-8
        assert list(body.orientations) == list(body.surfaces)
    moments = np.diag(all_.properties.inertia)
    np.testing.assert_allclose(all_.properties.centroid[1:], 0.0, atol=1e-9)
    np.testing.assert_allclose(moments[1], moments[2], rtol=1e-9)


def test_a_rim_ends_as_far_past_a_trimmed_edge_as_is_stated():
    cut = Cut(trailing_edge=AtRadius(radius=66.0), leading_edge=AtX(x=3.0))
    blade = with_parts(coarse.RADIAL, cut=cut, shroud_ring=Disc(thickness=2.0, upstream=1.5, downstream=1.0))
    (ring,) = wheel(blade).pitches
    line, ends = ring.carrier.line, np.array(ring.carrier.ends)
    first, last = line.at(np.array(line.blade))
    assert first[0] == pytest.approx(3e-3, rel=1e-7)
    assert last[1] == pytest.approx(66e-3, rel=1e-7)
    np.testing.assert_allclose(np.hypot(*(line.at(ends) - [first, last]).T), [1.5e-3, 1e-3], rtol=1e-3)


def test_a_rim_ends_as_far_past_a_cut_edge_with_a_fillet_too():
    cut, rim = Cut(trailing_edge=AtX(x=60.0)), Disc(thickness=2.0, upstream=3.0, downstream=2.0)
    blade = with_parts(coarse.ROTOR, cut=cut, disc=rim, hub_fillet=Fillet(radius=1.5))
    (pitch,) = sector(blade).pitches
    line, ends = pitch.carrier.line, np.array(pitch.carrier.ends)
    last = line.at(np.array(line.blade[1]))
    assert last[0] == pytest.approx(60e-3, rel=1e-7)
    assert np.hypot(*(line.at(ends[1]) - last)) == pytest.approx(2e-3, rel=1e-3)


def test_an_outline_stays_where_it_is_stated_when_the_blade_is_trimmed(shrouded):
    blade = replace(shrouded.design, cut=Cut(trailing_edge=AtRadius(radius=66.0))).build()
    disc, ring = wheel(blade).pitches
    assert disc.carrier.line.at(np.array(disc.carrier.ends[1]))[1] == pytest.approx(74e-3, rel=1e-9)
    assert 66e-3 < ring.carrier.line.at(np.array(ring.carrier.ends[1]))[1] < 73e-3


def test_the_walls_line_straightens_before_it_winds_a_turn(shrouded):
    blade = replace(shrouded, design=replace(shrouded.design, disc=Disc(thickness=3.0, upstream=150.0)))
    made = sector(blade)
    net = made.pitches[0].line.control_points
    assert np.ptp(np.unwrap(np.arctan2(net[:, 1], net[:, 2]))) < 2 * np.pi
    whole = sum(pitch.carrier.volume for pitch in made.pitches) + 9 * blade.properties.volume
    assert 9 * made.properties.volume == pytest.approx(whole, rel=1e-7)
    assert made.properties.openness < 1e-8
    # at the edges the line keeps slope and second derivative: it was the blade's own before
    knots = made.pitches[0].skin.knots
    assert knots.straightening is not None
    spec = PassageSpec(
        blade=blade, exact=blade.exact, half_pitch=np.asarray(0.5 * blade.design.spacing), turned=(None, None)
    )
    bent, plain = (
        spec.camber(each, np.array([0.0])).points("inlet", 1.0 - 1e-3 * np.arange(3.0))
        for each in (knots, replace(knots, straightening=None))
    )
    np.testing.assert_allclose(bent, plain, rtol=0, atol=1e-6)


@pytest.mark.parametrize(
    "part",
    [
        Disc(thickness=0.2, upstream=2000),
        pytest.param(outlined((-2000, 79), (-2000, 9), (97, 9), (97, 118.5)), marks=pytest.mark.slow),
    ],
)
def test_a_disc_that_reaches_further_than_its_wall_is_named_with_how_far_that_goes(part, rotor):
    name = "upstream" if part.outline is None else r"outline.points\[0\]"
    blade = replace(rotor, design=replace(rotor.design, disc=part))
    with pytest.raises(
        DesignError, match=rf"^disc.{name} is .*upstream of the blade the hub can be continued to \(-5"
    ) as e:
        wheel(blade)
    if part.outline is None:
        # straight on, the hub meets the axis some 548 upstream
        assert 500.0 < float(re.search(r"take ([\d.]+) at most", str(e.value))[1]) < 548.0


def test_a_thin_rim_that_ends_before_a_fillet_is_told_how_far_to_reach(rotor):
    design = replace(rotor.design, disc=Disc(thickness=3.0, upstream=0.1), hub_fillet=Fillet(radius=1.5))
    blade = design.build()
    with pytest.raises(DesignError, match=r"let disc.upstream be more than ([\d.]+)$") as e:
        wheel(blade)
    least = float(re.search(r"more than ([\d.]+)$", str(e.value))[1])
    assert (
        len(wheel(replace(blade, design=replace(design, disc=Disc(thickness=3.0, upstream=1.02 * least)))).pitches) == 1
    )


def test_faces_have_the_names_that_users_rely_on(bodies):
    discs = [f"disc_{number}" for number in range(1, 7)]
    outline = ["hub", "rim_front", *discs[:3], "bore", *discs[3:], "rim_back"]
    assert list(bodies["rotor"][0].surfaces)[2:] == ["blade_shroud", *outline, "cyclic_low", "cyclic_high"]
    names = set(bodies["shrouded"][1].surfaces)
    expected = {"blade_07_upper", "hub_01", "hub_09", "shroud_05", "rim_front", "rim_back", "bore", "disc_1"}
    assert expected | {"ring_front", "ring_outside", "ring_back"} <= names
    assert not {"blade_01_hub", "blade_01_shroud"} & names


def test_blades_of_a_wheel_are_turned_copies(rotor, bodies):
    made = bodies["rotor"][1]
    net = made.surfaces["blade_05_lower"].control_points
    own = rotor.surfaces["lower"].control_points
    np.testing.assert_allclose(net[..., 0], own[..., 0], rtol=0, atol=0)
    turn = np.angle((net[..., 2] + 1j * net[..., 1]) / (own[..., 2] + 1j * own[..., 1]))
    np.testing.assert_allclose(turn, 4 * 2 * np.pi / 17, rtol=1e-12)


def test_a_cyclic_face_is_straight_at_each_theta_and_its_neighbour_a_pitch_further(bodies):
    made = bodies["shrouded"][0]
    u, v = np.linspace(0.0, 1.0, 41)[:, None], np.linspace(0.0, 1.0, 5)
    for kind in ("cyclic", "ring_cyclic"):
        low, high = (made.surfaces[f"{kind}_{name}"](u, v) for name in ("low", "high"))
        theta = np.arctan2(low[..., 1], low[..., 2])
        np.testing.assert_allclose(theta, theta[:, :1] * np.ones(5), atol=1e-9)
        np.testing.assert_allclose(np.arctan2(high[..., 1], high[..., 2]) - theta, 2 * np.pi / 9, atol=1e-12)
        np.testing.assert_allclose(low[[0, -1], 0], low[[0, -1], -1], atol=1e-15)


def test_the_edges_of_a_cyclic_face_are_its_own_control_points_to_the_bit(bodies):
    (face,) = bodies["rotor"][0].cyclic
    own = list(map(tuple, face.surface.control_points[:, 1]))
    for edge in face.edges.values():
        first = own.index(tuple(edge.control_points[0]))
        assert own[first : first + len(edge.control_points)] == list(map(tuple, edge.control_points))


@pytest.mark.parametrize(
    "fillet", [pytest.param(None, marks=pytest.mark.slow), Fillet(radius=1.5)], ids=["plain", "filleted"]
)
def test_passage_and_sector_fill_the_annulus_between_bore_and_shroud(fillet):
    blade = with_parts(coarse.ROTOR, hub_fillet=fillet)
    around = passage(blade)
    duct, metre = around.duct, blade.design.metre
    ends = duct.lines(np.zeros(1)).position(np.array([duct.low, duct.high]))[0] / metre
    (x_0, r_0), (x_1, r_1) = ends
    disc = outlined((x_0, r_0), (x_0, 50.0), (x_1, 50.0), (x_1, r_1))
    made = sector(replace(blade, design=replace(blade.design, disc=disc)))
    metal = 17 * made.properties.volume + 17 * around.properties.volume
    annulus = annulus_volume(duct, around.camber.joints) + made.pitches[0].carrier.volume
    assert metal == pytest.approx(annulus, rel=1e-6)
    # a fillet's foot stands on the channel's own hub
    assert not made.pitches[0].skin.is_cut("hub")


@pytest.mark.parametrize("path", ["disc.outline.points[0].x", "stagger[1]"])
def test_volume_and_cyclic_faces_follow_the_parameters(rotor, bodies, path):
    knots, design = bodies["rotor"][0].knots, rotor.design
    value = design.parameters()[path]

    def figures(changed):
        made = sector(changed.build(knots=rotor.knots), knots=knots)
        net = made.surfaces["cyclic_high"].control_points
        return np.append(net.ravel() / rotor.chord, made.properties.volume / rotor.chord**3)

    exact = np.imag(figures(design.changed(path, value + 1e-30j))) / 1e-30
    ahead, behind = (figures(design.changed(path, value + step)) for step in (1e-3, -1e-3))
    np.testing.assert_allclose((ahead - behind) / 2e-3, exact, rtol=0, atol=2e-6 * np.abs(exact).max())


REFUSED = {
    "neither": ({}, "neither disc nor shroud_ring"),
    "off the hub": ({"disc": outlined((-8, 80), (-8, 40), (97, 40), (97, 118.5))}, r"points\[0\] is .* off the hub"),
    "against the flow": ({"disc": outlined((97, 118.5), (97, 40), (-8, 40), (-8, 94))}, "against the flow"),
    "behind the leading edge": ({"disc": outlined((3, 96.2), (3, 40), (97, 40), (97, 118.5))}, "at the leading edge"),
    "cuts the hub": ({"disc": outlined((-8, 94), (20, 90), (45, 120), (97, 40), (97, 118.5))}, "cuts the hub"),
    "cuts itself": (
        {"disc": outlined((-8, 94), (-8, 50), (60, 50), (20, 30), (20, 60), (97, 60), (97, 118.5))},
        "cuts itself",
    ),
    "in the flow": ({"disc": outlined((-8, 94), (-8, 130), (97, 130), (97, 118.5))}, "lies in the flow"),
    "large radius": ({"disc": outlined((-8, 94), (-8, 40), (97, 40), (97, 118.5), radii=(60, 60))}, "arcs take"),
    "along the hub": ({"disc": outlined((-8, 94), (40, 103), (60, 40), (97, 118.5))}, "meets the hub at"),
    "thick": ({"disc": Disc(thickness=150.0)}, "fold over or reach the axis"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_is_refused(name, rotor):
    parts, message = REFUSED[name]
    blade = replace(rotor, design=replace(rotor.design, **{"disc": None, **parts}))
    with pytest.raises(DesignError, match=message):
        wheel(blade)


def test_lines_of_a_recessed_outline_cross_but_its_wheel_is_made(rotor):
    spool = outlined(
        (-8, 94),
        (-8, 85),
        (40, 85),
        (40, 50),
        (-8, 50),
        (-8, 30),
        (97, 30),
        (97, 50),
        (45, 50),
        (45, 90),
        (97, 105),
        (97, 118.5),
    )
    blade = replace(rotor, design=replace(rotor.design, disc=spool))
    with pytest.raises(DesignError, match=r"lines cross near .* build the wheel"):
        sector(blade)
    assert len(wheel(blade).surfaces) == 17 * 4 + 11
