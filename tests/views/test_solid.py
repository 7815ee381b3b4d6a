"""The view in space: the blade where it stands, its neighbours and the hub."""

from dataclasses import replace
from itertools import combinations
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text

from bladewright.files.changing import changed_design
from bladewright.files.examples import example_text
from bladewright.files.reading import parsed
from bladewright.views.solid import draw_solid, positions, viewpoint
from machines import COARSE


@pytest.fixture
def view(blade_drawn):
    axes = Figure().add_subplot()
    draw_solid(axes, blade_drawn.built, neighbours=1, width=240)
    return axes


def is_blue(picture):
    return (picture[..., 2] > 1.25 * picture[..., 0]) & (picture[..., 3] > 0.5)


def test_the_native_blade_is_where_blue_is_drawn(blade_drawn, view):
    image = view.get_images()[0]
    picture, (left, right, low, high) = np.asarray(image.get_array()), image.get_extent()
    u, v = np.meshgrid(np.linspace(0.0, 1.0, 161), np.linspace(0.0, 1.0, 81))
    axes = viewpoint(blade_drawn.built)
    sides = [blade_drawn.built.surfaces[name](u, v).reshape(-1, 3) for name in ("upper", "lower")]
    flat = blade_drawn.per_metre * np.concatenate(sides) @ axes[:2].T
    size = np.array([right - left, high - low]) / picture.shape[1::-1]
    column, row = ((flat - [left, low]) / size).astype(int).T
    blue = is_blue(picture)
    assert blue.sum() > 200
    # every blue pixel has points of the blade within two pixels of it
    near = np.zeros_like(blue)
    for down in range(-2, 3):
        for aside in range(-2, 3):
            near[
                np.clip(picture.shape[0] - 1 - row + down, 0, picture.shape[0] - 1), np.clip(column + aside, 0, 239)
            ] = True
    assert (near | ~blue).mean() > 0.9999
    assert (picture[picture.shape[0] - 1 - row, column, 3] > 0.0).mean() > 0.995  # all but the rim


def test_lengths_are_to_scale_in_both_directions(blade_drawn, view):
    image = view.get_images()[0]
    left, right, low, high = image.get_extent()
    height, width = image.get_array().shape[:2]
    assert (right - left) / width == pytest.approx((high - low) / height, rel=5e-3)  # a row in 200 is rounded
    assert right - left > blade_drawn.per_metre * blade_drawn.built.chord / 3.0
    bar = next(text.get_text() for text in view.texts if text.get_text().endswith(blade_drawn.unit))
    start, end = view.get_lines()[0].get_xdata()
    assert end - start == pytest.approx(float(bar.split()[0]))


def test_the_directions_of_the_axes_are_named(view):
    assert {"x", "y", "z"} < {text.get_text() for text in view.texts}


def test_a_row_goes_once_around_and_the_blade_itself_is_in_it(blade_drawn):
    places = positions(blade_drawn.built, None)
    assert 0.0 in places
    if blade_drawn.name == "cascade":
        assert np.diff(places) == pytest.approx(0.0575 * blade_drawn.per_metre)
    else:
        assert len(places) == blade_drawn.design.blade_count
        assert np.diff(places) == pytest.approx(2.0 * np.pi / blade_drawn.design.blade_count)
    assert len(positions(blade_drawn.built, 1)) == 3


def test_a_blade_without_near_neighbours_stands_alone(cascade_drawn):
    wide = cascade_drawn.design.changed("pitch", 100.0).build()
    assert positions(wide, 2) == [0.0]


class Walls(NamedTuple):
    """An exact blade that knows its walls alone."""

    hub: list
    shroud: list
    mapping: SimpleNamespace = SimpleNamespace(revolved=True)

    def wall_points(self, name, u):
        ends = np.array(getattr(self, name), dtype=float)
        return ends[0] + u[:, None] * (ends[1] - ends[0])


@pytest.mark.parametrize(("hub", "upstream"), [((50, 20), False), ((20, 50), True), ((20, 20), True)])
def test_the_viewer_looks_at_the_smaller_end_of_the_hub(hub, upstream):
    walls = Walls([(0, hub[0]), (40, hub[1])], [(0, 60), (40, 60)])
    towards = viewpoint(SimpleNamespace(exact=walls))[2]
    assert (towards[0] < 0.0) == upstream


@pytest.mark.parametrize("side", [-20.0, 20.0])
def test_the_viewer_looks_at_a_disc_from_the_side_of_its_blades(side):
    walls = Walls([(0, 50), (0, 90)], [(side, 50), (side, 90)])
    assert np.sign(viewpoint(SimpleNamespace(exact=walls))[2][0]) == np.sign(side)


@pytest.mark.parametrize("name", ["marine-propeller", "propeller"])
def test_the_names_of_rotation_flow_and_suction_side_lie_apart(name):
    changes = {"tolerance": COARSE, **({"hub_fillet": None} if name == "marine-propeller" else {})}
    design = replace(changed_design(parsed(example_text(name), name), name, {}), **changes)
    figure = Figure(figsize=(4.5, 5.0))
    draw_solid(figure.add_subplot(), design.build(), neighbours=1, width=100)
    FigureCanvasAgg(figure).draw()
    words = [each for each in figure.axes[0].texts if each.get_text() in {"rotation", "flow", "suction\nside"}]
    assert len(words) == 3
    boxes = [Text.get_window_extent(each) for each in words]
    assert not any(one.overlaps(other) for one, other in combinations(boxes, 2))
