"""Faces as grids, and bodies of several blades in space: what is drawn is what is built."""

import numpy as np
import pytest
from matplotlib.figure import Figure

from bladewright.blade.design.cut import AtX, Cut
from bladewright.blade.design.disc import Disc
from bladewright.blade.design.fillet import Fillet
from bladewright.domain.row import row
from bladewright.domain.wheel import wheel
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.revolution import Revolution
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface
from bladewright.views import body, body_view
from bladewright.views.body import body_figures, body_scene, carried_lines, chained
from bladewright.views.faces import borders, is_closed, meridian_line, sampled
from bladewright.views.meridional import draw_meridional
from bladewright.views.picture import sheet
from bladewright.views.sections import draw_feet, foot_in_plane
from bladewright.views.solid import BLADE, FILLET, HUB, mixed
from bladewright.views.view3d import all_points
from machines import built
from machines.coarse import BLADES

SHARES = np.linspace(0.0, 1.0, 41)


def line(*points):
    return Curve(control_points=np.array(points, float), knots=np.array([0.0, 0.0, 1.0, 1.0]), degree=1)


def disc_between(corners):
    """A trimmed piece of the plane z = 0, of which u and v are x and y."""
    net = np.array([[[0, 0, 0], [0, 4, 0]], [[4, 0, 0], [4, 4, 0]]], float)
    knots = np.array([0.0, 0.0, 4.0, 4.0])
    plane = Surface(control_points=net, knots_u=knots, knots_v=knots, degree_u=1, degree_v=1)
    around = [line(start, end) for start, end in zip(corners, [*corners[1:], corners[0]], strict=True)]
    return TrimmedSurface(surface=plane, boundary=tuple(around))


def test_the_grid_of_a_trimmed_face_reaches_from_border_to_border():
    points, normals = sampled(disc_between([(1, 1), (3, 1), (2, 3)]), SHARES, SHARES)
    x, y, _ = np.moveaxis(points / 1e3, -1, 0)
    assert x.min() == pytest.approx(1.0, abs=1e-5)
    assert x.max() == pytest.approx(3.0, abs=1e-5)
    np.testing.assert_allclose(y[:, 0], 1.0, atol=1e-9)
    np.testing.assert_allclose(y[:, -1], 3.0 - 2.0 * np.abs(x[:, -1] - 2.0), atol=1e-2)
    np.testing.assert_allclose(normals, np.broadcast_to([0.0, 0.0, 1.0], normals.shape), atol=1e-12)


def test_the_grid_of_a_blade_s_end_lies_inside_its_boundary():
    blade = built(BLADES["rotor"])
    end = blade.surfaces[blade.design.ends[1]]
    points = sampled(end, SHARES, SHARES)[0] / 1e3
    outline = np.concatenate([curve(np.linspace(*curve.domain, 2001)) for curve in blade.end_outline("shroud")])
    rows = np.concatenate([points[:, 0], points[:, -1]])
    gaps = np.min(np.linalg.norm(rows[:, None] - outline, axis=-1), axis=1)
    assert gaps.max() < 2e-3 * blade.chord


def test_a_face_of_revolution_knows_its_meridian_and_its_circles():
    cone = Revolution(meridian=line((0.0, 1.0), (2.0, 3.0)), start=0.3, end=0.3 + 2.0 * np.pi).surface()
    flat = meridian_line(cone) / 1e3
    np.testing.assert_allclose(flat[:, 1], flat[:, 0] + 1.0, atol=1e-9)
    assert np.ptp(flat[:, 0]) == pytest.approx(2.0)
    assert sum(is_closed(border) for border in borders(cone)) == 2


@pytest.mark.parametrize("backwards", [False, True])
def test_lines_are_chained_around_whatever_their_order_and_sense(backwards):
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0]])
    sides = [square[k : k + 2][:: -1 if backwards and k % 2 else 1] for k in (0, 2, 3, 1)]
    x, y = chained(sides).T
    assert 0.5 * abs(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))) == pytest.approx(1.0)


@pytest.mark.parametrize("name", ["rotor", "cascade"])
def test_a_row_is_drawn_at_its_placements(name):
    blade = built(BLADES[name])
    whole = row(blade, None if blade.design.blade_count else 3)
    scene = body_scene(whole)
    assert [len(group.turns) for group in scene.groups] == [len(whole.placements)]
    drawn, unit = all_points(scene), 1e3
    corners = [unit * whole.surfaces[f"{place.name}_upper"](0.0, 0.0) for place in whole.placements]
    gaps = np.min(np.linalg.norm(drawn[:, None] - np.array(corners), axis=-1), axis=0)
    np.testing.assert_allclose(gaps, 0.0, atol=1e-9 * np.ptp(drawn))
    assert carried_lines(whole) == {}


def test_the_sheet_and_the_view_of_a_row_are_drawn(tmp_path, monkeypatch):
    for size in ("ALONE", "BESIDE"):
        monkeypatch.setattr(body, size, (120, 120))
    whole = row(built(BLADES["cascade"]), 2)
    panels = {axes.get_title(loc="left") for axes in sheet(whole).axes}
    assert {"In space", "The other side", "Half section", "Figures"} <= panels
    body_view(whole, tmp_path / "row.png")
    assert (tmp_path / "row.png").read_bytes().startswith(b"\x89PNG")
    names = dict(body_figures(whole))
    assert names["of a blade"].startswith("upper, lower")


def test_without_a_fillet_the_foot_is_the_section():
    blade = built(BLADES["rotor"])
    foot, section = foot_in_plane(blade, "hub", 0.0), blade.section(0.0)
    sides = np.concatenate([np.real(section.curves[name](np.linspace(0.0, 1.0, 4001))) for name in ("upper", "lower")])
    gaps = np.min(np.linalg.norm(foot[:, None] - sides, axis=-1), axis=1)
    assert gaps.max() < 1e-3 * np.ptp(sides)


@pytest.fixture(scope="module")
def wheel_drawn():
    parts = {"disc": Disc(thickness=8.0), "hub_fillet": Fillet(radius=4.0)}
    return wheel(BLADES["rotor"].changed(parts).build())


def test_what_a_wheel_is_drawn_to_cover_has_its_volume(wheel_drawn):
    outline = chained(carried_lines(wheel_drawn)["disc"]) / 1e3
    (x, r), (next_x, next_r) = outline.T, np.roll(outline, -1, axis=0).T
    # Green: the integral of pi r^2 dx along straight lines
    disc = abs(np.sum(np.pi / 3.0 * (r**2 + r * next_r + next_r**2) * (next_x - x)))
    blades = wheel_drawn.blade.design.blade_count * wheel_drawn.blade.properties.volume
    assert disc + blades == pytest.approx(wheel_drawn.properties.volume, rel=1e-4)


def test_a_wheel_is_drawn_from_one_blade_and_one_piece_of_its_wall(wheel_drawn):
    repeated, once = body_scene(wheel_drawn).groups
    assert len(repeated.turns) == wheel_drawn.blade.design.blade_count
    names = [name for name in wheel_drawn.surfaces if "_01" in name]
    assert len(repeated.surfaces) == len(names) == 8  # both sides, both strips, both fillets, the shroud's end, the hub
    assert len(once.surfaces) == len(wheel_drawn.surfaces) - len(names) * len(repeated.turns)
    assert {surface.colour for surface in repeated.surfaces} == {BLADE, mixed(BLADE, FILLET), HUB}


def test_a_fillet_is_seen_in_the_pictures_of_its_blade(wheel_drawn):
    blade, axes = wheel_drawn.blade, Figure().add_subplot()
    draw_meridional(axes, blade)
    assert "fillet" in axes.get_legend_handles_labels()[1]
    draw_feet(axes, blade, [blade.section(0.0), blade.section(1.0)])
    assert [name for name in axes.get_legend_handles_labels()[1] if "foot" in name] == ["foot at hub"]
    foot = foot_in_plane(blade, "hub", 0.0)
    section = np.concatenate([np.real(curve(SHARES)) for curve in blade.section(0.0).curves.values()])
    assert np.all(foot.min(axis=0) < section.min(axis=0))
    assert np.all(foot.max(axis=0) > section.max(axis=0))


def test_a_cut_is_seen_in_the_meridional_picture_of_its_blade():
    axes = Figure().add_subplot()
    draw_meridional(axes, BLADES["rotor"].changed("cut", Cut(leading_edge=AtX(x=30.0))).build())
    lines = {line.get_label(): line for line in axes.get_lines()}
    np.testing.assert_allclose(lines["cut"].get_xdata(), 30.0)
    assert "blade" in axes.get_legend_handles_labels()[1]
