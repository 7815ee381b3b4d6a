"""Pictures of passages: what is drawn is the native geometry, in the units on the axes, and what hides it is glass."""

from functools import cache
from importlib import import_module
from itertools import combinations
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.image import imread

from bladewright import views
from bladewright.domain.build import passage
from bladewright.domain.passage import Passage
from bladewright.domain.section import section_passage
from bladewright.errors import DesignError
from bladewright.views.passage import boundary, figures, poles
from bladewright.views.picture import sheet
from bladewright.views.raster import Camera, ShadedGrid, rendered
from bladewright.views.solid import draw_passage_solid, outer_faces, outer_grids, viewpoint
from bladewright.views.walls import patch_lines, patch_lines_near, unwrapped, unwrapped_face, wall_scale
from machines import COARSE, built, example
from machines.sectioned import DIFFUSER
from machines.unified import DRAWN_IMPELLER as IMPELLER

EXACT = 1e-9
"""mm, of lines some 100 mm long: rounding of trigonometry and of a nearest place"""
PASSAGES = {
    "impeller": IMPELLER.changed("tip_clearance", 0.5),
    "cascade": example("vki-ls89").changed("tolerance", COARSE),
}


@cache
def _made(name):
    return passage(built(PASSAGES[name]))


@pytest.fixture(scope="module", params=list(PASSAGES))
def made(request):
    """A passage that turns from axial to radial with a gap, and a plane one."""
    return _made(request.param)


@pytest.fixture
def wrapped():
    return _made("impeller")


@pytest.fixture
def plane():
    return _made("cascade")


@pytest.fixture(scope="module")
def drawn(made):
    with pytest.MonkeyPatch.context() as coarse:
        coarse.setattr("bladewright.views.passage.VIEW", (160, 160))
        figure = sheet(made)
    figure.canvas.draw()
    return SimpleNamespace(passage=made, figure=figure)


def panel(figure, title):
    return next(axes for axes in figure.axes if axes.get_title(loc="left").startswith(title))


def line(axes, name):
    return next(np.column_stack(each.get_data()) for each in axes.get_lines() if each.get_label() == name)


def meridional(made, points):
    radius = np.hypot(points[..., 1], points[..., 2]) if made.duct.revolved else points[..., 2]
    return 1e3 * np.stack([points[..., 0], radius], axis=-1)


def test_the_duct_is_where_the_native_walls_and_openings_are(drawn):
    axes, faces = panel(drawn.figure, "Meridional duct"), drawn.passage.whole
    for wall, v in (("hub", 0.0), ("shroud", 1.0)):
        duct = line(axes, wall)
        native = meridional(drawn.passage, faces[f"{wall}_upper"](np.linspace(0.0, 1.0, 41)[:, None], [0.3, 0.9]))
        step = np.max(np.linalg.norm(np.diff(duct, axis=0), axis=1))
        apart = np.linalg.norm(native.reshape(-1, 1, 2) - duct, axis=-1).min(axis=1)
        assert apart.max() < 0.51 * step  # half way between drawn points, and the bend of the wall
        assert np.allclose(duct[[0, -1]], meridional(drawn.passage, faces["periodic_upper"]([0.0, 1.0], v)), atol=EXACT)
    for name, end in (("inlet", 0.0), ("outlet", 1.0)):
        wanted = meridional(drawn.passage, faces["periodic_upper"](end, np.linspace(0.0, 1.0, 101)))
        assert np.allclose(line(axes, name), wanted, atol=EXACT)
    for name, end in (("leading edge", 0.0), ("trailing edge", 1.0)):
        wanted = meridional(drawn.passage, drawn.passage.blade.surfaces["upper"](end, np.linspace(0.0, 1.0, 101)))
        assert np.allclose(line(axes, name), wanted, atol=EXACT)
    assert any("clearance 0.5 mm" in each.get_label() for each in axes.get_lines()) == drawn.passage.duct.revolved


def test_a_wall_in_its_plane_goes_back_to_the_native_points(made):
    u, v = np.linspace(0.0, 1.0, 23), np.linspace(0.0, 1.0, 5)
    for name, half in made.walls.items():
        plane = unwrapped_face(made, name, u, v) / wall_scale(made, name.split("_")[0])
        position = np.real(half.line.position(half.line.u_at(plane[..., 0].reshape(1, -1))))[0].reshape(23, 5, 2)
        (x, radius), across = np.moveaxis(position, -1, 0), plane[..., 1]
        points = [x, radius * np.sin(across), radius * np.cos(across)] if made.duct.revolved else [x, across, radius]
        # the native wall lies within 1e-7 of the chord on its surface of revolution
        assert np.allclose(np.stack(points, axis=-1), made.whole[name].grid(u, v), atol=1e-7 * made.blade.chord)


def test_periodic_boundaries_are_one_pitch_apart_in_the_plane(made):
    count, ends = made.blade.design.blade_count, np.array([1.0])
    for wall in ("hub", "shroud"):
        upper, lower = (
            unwrapped_face(made, f"{wall}_{half}", np.linspace(0, 1, 31), ends) for half in ("upper", "lower")
        )
        pitch = 2.0 * np.pi / count * wall_scale(made, wall) if count else 57.5
        assert np.allclose(upper - lower, [0.0, pitch], atol=1e-6)  # walls are within 1e-7 of the chord, not exact


def test_theta_is_followed_where_a_wall_wraps_around_the_axis(wrapped):
    points = wrapped.whole["hub_upper"].grid(np.linspace(0.0, 1.0, 31), np.array([1.0]))
    plane = unwrapped(wrapped, "hub", points)
    for turn in (3.0, -5.0):
        shifted = SimpleNamespace(
            duct=wrapped.duct,
            walls=wrapped.walls,
            camber=SimpleNamespace(
                lines=wrapped.camber.lines,
                points=lambda piece, t, by=turn: wrapped.camber.points(piece, t) + np.array([0.0, by]),
            ),
        )
        x, y, z = np.moveaxis(points, -1, 0)
        turned = np.stack([x, y * np.cos(turn) + z * np.sin(turn), z * np.cos(turn) - y * np.sin(turn)], axis=-1)
        moved = unwrapped(shifted, "hub", turned)
        assert np.allclose(moved - plane, [0.0, turn * wall_scale(wrapped, "hub")], atol=EXACT)


def test_the_lines_of_both_patches_are_drawn_with_their_least_jacobians(drawn):
    made = drawn.passage
    for wall in ("hub", "shroud"):
        axes = panel(drawn.figure, wall.capitalize())
        collections = [each for each in axes.collections if isinstance(each, LineCollection)]
        for half, shown in zip(("upper", "lower"), collections, strict=True):
            wanted = patch_lines(made, f"{wall}_{half}")
            assert len(shown.get_segments()) == len(wanted) == 9 + 17 + 9 - 2 + 9
            assert all(np.array_equal(one, other) for one, other in zip(shown.get_segments(), wanted, strict=True))
            share, u, v = made.folds[f"{wall}_{half}"]
            label = f"{half}: least Jacobian {share:.2g} of its median, at u = {round(u, 3):g}, v = {round(v, 3):g}"
            place = unwrapped_face(made, f"{wall}_{half}", np.array([u]), np.array([v]))[0, 0]
            assert np.allclose(line(axes, label), place, atol=EXACT)
        assert ("tip, off the wall" in axes.get_legend_handles_labels()[1]) == (wall not in made.blade.surfaces)


def test_the_wall_of_a_gap_behind_a_blunt_edge_is_drawn_where_it_is():
    made = passage(built(DIFFUSER.changed({"tip_clearance": 0.6, "tolerance": COARSE})))
    points, normals = next(each[1:] for each in outer_grids(made, np.linspace(0.0, 1.0, 9)) if each[0] == "shroud_gap")
    # plane walls across the axis: the gap is its width away from the tip, and faces away from it
    away = points[..., 0] - 1e3 * made.blade.sides[0](0.5, 1.0)[0]
    assert np.abs(away) == pytest.approx(np.full(away.shape, 0.6), abs=1e-9)
    assert normals[1:, 1:, 0] * np.sign(away[1:, 1:]) == pytest.approx(np.ones((8, 8)), abs=1e-9)


def test_lines_close_by_are_on_the_patch_and_pass_the_place(made):
    name, (_, u, v) = min(made.folds.items(), key=lambda fold: fold[1][0])
    place = unwrapped_face(made, name, np.array([u]), np.array([v]))[0, 0]
    reach = 0.03e3 * made.blade.chord
    lines = patch_lines_near(made, name, place, u, reach)
    nearest = np.sort([np.min(np.linalg.norm(each - place, axis=1)) for each in lines])
    assert nearest[0] < 0.01 * reach
    assert np.sum(nearest < reach) > 20
    assert np.max(np.diff(nearest[nearest < reach])) < 0.2 * reach


def test_the_figures_are_those_of_the_passage(drawn):
    made, said = drawn.passage, dict(figures(drawn.passage))
    volume, unit = said["passage"].split()
    assert float(volume) * {"mm³": 1e-9, "cm³": 1e-6}[unit] == pytest.approx(float(made.properties.volume), rel=1e-4)
    assert [float(value) for name, value in said.items() if "(passage + blade)" in name] == [
        float(f"{made.ring_error:.1e}")
    ]
    assert float(said["off their surfaces / chord"]) == float(f"{made.wall_error:.1e}")
    assert said["upstream"].startswith(f"{made.knots.upstream:.3g} x {1e3 * made.knots.length:.4g} mm")
    for name, face in made.whole.items():
        shape = getattr(face, "surface", face).control_points.shape
        assert said[name.replace("_", " ")] == f"{shape[0]} x {shape[1]}"
    written = [text.get_text() for text in panel(drawn.figure, "Figures").texts]
    assert written[::2] == [name for name, _ in figures(made)]
    assert f"least Jacobian {min(share for share, _, _ in made.folds.values()):.2g}" in drawn.figure.texts[1].get_text()


def test_poles_of_split_faces_are_given_piece_by_piece(made):
    split = SimpleNamespace(surfaces=passage(made.blade, knots=made.knots, split=True).surfaces)
    counts = [split.surfaces[f"hub_upper_{piece}"].control_points.shape[0] for piece in ("inlet", "blade", "outlet")]
    across = made.whole["hub_upper"].control_points.shape[1]
    assert poles(split, "hub_upper") == f"({' + '.join(map(str, counts))}) x {across}"
    assert poles(split, "inlet").startswith("(")
    assert poles(split, "blade_upper") == poles(made, "blade_upper")


def test_a_volume_that_misses_the_ring_is_seen():
    blade = SimpleNamespace(design=SimpleNamespace(blade_count=4), properties=SimpleNamespace(volume=2.0))
    asked = SimpleNamespace(blade=blade, properties=SimpleNamespace(volume=3.0), ring=20.0)
    assert Passage.ring_error.func(asked) == 0.0
    asked.ring = 25.0
    assert Passage.ring_error.func(asked) == pytest.approx(-0.2)


def test_no_text_covers_another_or_leaves_the_sheet(drawn):
    from .test_sheet import texts_of

    canvas = drawn.figure.canvas
    renderer, (width, height) = canvas.get_renderer(), canvas.get_width_height()
    boxes = [(text.get_text(), text.get_window_extent(renderer)) for text in texts_of(drawn.figure)]
    assert len(boxes) > 60
    for name, box in boxes:
        assert min(box.x0, box.y0, width - box.x1, height - box.y1) >= 0.0, name
    for (first, one), (second, other) in combinations(boxes, 2):
        overlap = min(one.x1, other.x1) - max(one.x0, other.x0), min(one.y1, other.y1) - max(one.y0, other.y0)
        assert min(overlap) <= 1.0, (first, second)  # a pixel: boxes are rounded outwards


def test_the_view_holds_the_passage_and_shows_the_blade_in_it(made):
    axes = Figure().add_subplot()
    draw_passage_solid(axes, made, size=(240, 240))
    image = axes.get_images()[0]
    picture, (left, right, low, high) = np.asarray(image.get_array()), image.get_extent()
    assert max(picture.shape[:2]) in range(238, 243)
    size = np.array([right - left, high - low]) / picture.shape[1::-1]

    def pixels(points):
        flat = 1e3 * points.reshape(-1, 3) @ viewpoint(made.blade)[:2].T
        column, row = ((flat - [left, low]) / size).astype(int).T
        return picture[np.clip(picture.shape[0] - 1 - row, 0, picture.shape[0] - 1), column]

    # two hundredths of a face's width are less than a pixel where it is seen aslant
    inner = np.linspace(0.03, 0.97, 41)
    for name in outer_faces(made):
        # seen from within or, as glass, from outside: every place of a face is drawn upon, all but the rim
        assert (pixels(made.whole[name].grid(inner, inner))[:, 3] > 0.0).mean() > 0.995
    blade = np.concatenate([pixels(made.blade.surfaces[name].grid(inner, inner)) for name in ("upper", "lower")])
    assert ((blade[:, 2] > 1.2 * blade[:, 0]) & (blade[:, 3] > 0.9)).mean() > 0.3
    assert {"inlet", "outlet"} < {text.get_text() for text in axes.texts}


FRONT = Camera(axes=np.eye(3), corner=np.array([-1.0, -1.0]), extent=np.array([2.0, 2.0]))


def square(half, z, colour, side=0, towards=1.0):
    a = np.linspace(-half, half, 3)
    points = np.stack(np.broadcast_arrays(a[:, None], a, z), axis=-1)
    return ShadedGrid(
        points=points, normals=np.broadcast_to([0.0, 0.0, towards], points.shape), colour=colour, side=side
    )


@pytest.mark.parametrize(("towards", "side", "seen"), [(1.0, 1, True), (-1.0, 1, False), (-1.0, -1, True)])
def test_a_mesh_with_a_side_is_drawn_where_that_faces_the_viewer(towards, side, seen):
    picture = rendered([square(0.5, 0.0, (0.9, 0.1, 0.1), side, towards)], [], FRONT, 40)
    assert (picture[20, 20, 3] > 0.0) == seen


def test_glass_dims_what_is_behind_it_and_not_what_is_before_it():
    red, glass = (0.9, 0.1, 0.1), (0.2, 0.9, 0.2)
    plain = rendered([square(0.4, 0.0, red)], [], FRONT, 40)
    before, behind = (
        rendered([square(0.4, 0.0, red)], [], FRONT, 40, glass=[square(0.8, z, glass)]) for z in (0.5, -0.5)
    )
    assert np.allclose(behind[20, 20], plain[20, 20], atol=1e-6)  # single precision
    assert before[20, 20, 1] > plain[20, 20, 1] + 0.02
    assert before[20, 20, 0] > before[20, 20, 1]
    assert before[20, 20, 3] == 1.0
    for picture in (before, behind):
        assert 0.0 < picture[20, 5, 3] < 0.5
        assert picture[20, 1, 3] == 0.0


def test_a_section_is_drawn_within_its_curves(section_drawn):
    made = section_passage(section_drawn.built, 0.0575, outlet_angle=-70.0)
    figure = sheet(section_drawn.design, made)
    axes = panel(figure, "Flow domain, pitch 5.75 cm")
    for name in ("periodic_lower", "periodic_upper", "inlet", "outlet"):
        shown = line(axes, name.replace("_", " "))
        low, high = made.curves[name].domain
        assert np.allclose(shown[[0, 300, -1]], 1e2 * made.curves[name]([low, (low + high) / 2.0, high]), atol=EXACT)
        assert np.allclose(shown, 0.1 * boundary(made, name), atol=EXACT)
    assert "vane-passage" in figure.texts[0].get_text()
    said = [text.get_text() for text in panel(figure, "Figures").texts]
    assert said[said.index("passage") + 1] == f"{1e4 * float(made.area):.5g} cm²"
    assert sheet(made).texts[0].get_text() == "section-passage"


def test_the_passage_alone_is_drawn_on_a_page(plane, tmp_path, monkeypatch):
    monkeypatch.setattr(import_module("bladewright.views.picture"), "PASSAGE_VIEW", (240, 240))
    views.passage_view(plane, tmp_path / "view.png")
    image = imread(tmp_path / "view.png")
    assert image.shape[:2] == (1280, 1600)
    assert 0.1 < (image[..., :3].min(axis=-1) < 0.97).mean() < 0.9


def test_only_a_passage_has_the_view_of_one(section_drawn, tmp_path):
    with pytest.raises(DesignError, match=r"a Section was given: only a passage has this view; .* passage\(blade\)"):
        views.passage_view(section_drawn.built, tmp_path / "view.png")
    assert not list(tmp_path.iterdir())
