"""The 2D section: its properties against independent figures, its derivatives, its refusals."""

import numpy as np
import pytest

from bladewright.errors import DesignError
from bladewright.section.crossing import self_crossings, touching
from bladewright.section.unified import UnifiedSection

VANE = UnifiedSection(
    name="vane",
    length_unit="mm",
    pitch=57.5,
    leading_edge_x=3.0,
    leading_edge_y=-2.0,
    axial_chord=36.8,
    stagger=-54.9,
    metal_angle_in=6.0,
    metal_angle_out=-74.0,
    tangent_in=0.45,
    tangent_out=0.54,
    leading_edge_radius=0.15,
    trailing_edge_radius=0.0114,
    thickness_upper=(0.08, 0.4, 0.35, 0.22, 0.11, 0.044, 0.012),
    thickness_lower=(0.08, 0.084, 0.17, 0.116, 0.041, 0.035, 0.026),
)


def outline(section, count):
    u = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, count))) / 2.0
    return np.concatenate([section.curves["upper"](u)[::-1], section.curves["lower"](u)[1:-1]])


def test_area_and_centroid_are_the_limit_of_inscribed_polygons():
    section = VANE.build()
    errors, shifts = [], []
    for count in (201, 401, 801):
        x, y = outline(section, count).T
        cross = x * np.roll(y, -1) - np.roll(x, -1) * y
        area = np.sum(cross) / 2.0
        centre = [np.sum((c + np.roll(c, -1)) * cross) / (6.0 * area) for c in (x, y)]
        errors.append(abs(area / section.area - 1.0))
        shifts.append(np.linalg.norm(centre - section.centroid) / section.chord)
    # an inscribed polygon misses an area by the square of its step: a quarter each time
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.05)
    assert errors[1] / errors[2] == pytest.approx(4.0, rel=0.05)
    assert errors[2] < 1e-4
    assert shifts[2] < 1e-4


def test_perimeter_is_the_limit_of_inscribed_polygons():
    section = VANE.build()
    points = outline(section, 20001)
    total = np.sum(np.linalg.norm(points - np.roll(points, -1, axis=0), axis=-1))
    assert total == pytest.approx(section.perimeter, rel=1e-6)


def test_the_section_has_the_edges_chord_and_angles_asked_for():
    section = VANE.build()
    assert section.edge_radii == pytest.approx((0.15 * 36.8e-3, 0.0114 * 36.8e-3), rel=1e-9)
    assert section.chord == pytest.approx(36.8e-3 / np.cos(np.radians(54.9)), rel=1e-12)
    assert section.camber.control_points[0] == pytest.approx([3e-3, -2e-3], abs=1e-15)
    slope = section.camber.derivative(np.array([0.0, 1.0]))
    assert np.degrees(np.arctan2(slope[:, 1], slope[:, 0])) == pytest.approx([6.0, -74.0], abs=1e-9)
    assert np.degrees([section.stagger, section.metal_angle_in, section.metal_angle_out]) == pytest.approx(
        [-54.9, 6.0, -74.0], abs=1e-12
    )


def test_maximum_thickness_is_that_of_rays_across_the_camber():
    section = VANE.build()
    thickest, place = section.maximum_thickness
    u = np.linspace(max(place - 0.02, 0.0), place + 0.02, 5)
    widths = []
    for point, slope in zip(section.camber(u), section.camber.derivative(u), strict=True):
        normal = np.array([-slope[1], slope[0]]) / np.linalg.norm(slope)
        width = 0.0
        for name, sign in (("upper", 1.0), ("lower", -1.0)):
            dense = section.curves[name](np.linspace(0.0, 1.0, 200001)) - point
            beside = dense @ (np.array([normal[1], -normal[0]]))
            height = dense @ normal * sign
            width += np.min(height[(np.abs(beside) < 2e-7) & (height > 0.0)])
        widths.append(width)
    assert max(widths) == pytest.approx(thickest, rel=1e-4)


def test_a_flat_camber_of_equal_sides_is_symmetric():
    design = VANE.changed(
        {
            "stagger": 0.0,
            "metal_angle_in": 0.0,
            "metal_angle_out": 0.0,
            "thickness_lower": VANE.thickness_upper,
            "leading_edge_y": 0.0,
        }
    )
    section = design.build()
    u = np.linspace(0.0, 1.0, 101)
    upper, lower = (section.curves[name](u) for name in ("upper", "lower"))
    assert upper * [1.0, -1.0] == pytest.approx(lower, abs=1e-16)
    assert section.centroid[1] == pytest.approx(0.0, abs=1e-16)


@pytest.mark.parametrize("path", [path for path in VANE.parameters() if path != "pitch"])
def test_every_parameter_moves_the_section_and_its_complex_step_is_its_derivative(path):
    value, u = VANE.parameters()[path], np.linspace(0.0, 1.0, 41)

    def points(at):
        section = VANE.changed(path, at).build()
        return np.concatenate([section.curves[name](u) for name in ("upper", "lower")])

    analytic = np.imag(points(value + 1e-30j)) / 1e-30
    step = 1e-5 * max(1.0, abs(value))
    central = (points(value + step) - points(value - step)) / (2.0 * step)
    assert np.max(np.abs(analytic)) > 0.0
    # central differences err by step^2 and by rounding over the step: 1e-7 of the largest derivative
    assert analytic == pytest.approx(central, abs=2e-7 * np.max(np.abs(analytic)))


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"stagger": 90.0}, ["stagger", "90", "-90 and 90"]),
        ({"thickness_lower[2]": -0.01}, ["thickness_lower[2]", "-0.01", "positive"]),
        ({"trailing_edge_radius": 0.5}, ["trailing_edge_radius", "0.5", "at most", "raise"]),
        ({"trailing_edge_radius": 0.0}, ["trailing_edge_radius", "0"]),
        ({"axial_chord": float("nan")}, ["axial_chord", "finite"]),
        ({"axial_chord": -1.0}, ["axial_chord", "positive"]),
        ({"pitch": 5.0}, ["pitch", "5", "intersect"]),
        ({"thickness_upper": ()}, ["thickness_upper", "empty"]),
        ({"samples": 2}, ["samples", "2", "3 to 60"]),
        ({"tangent_in": 1.5}, ["tangent_in", "1.5"]),
        ({"name": "a/b"}, ["name", "a/b"]),
        ({"length_unit": "mmm"}, ["length_unit", "mmm", "mm"]),
    ],
)
def test_an_impossible_section_is_refused_with_path_value_and_cure(changes, words):
    with pytest.raises(DesignError) as caught:
        VANE.changed(changes).build()
    assert all(word in str(caught.value) for word in words)


def test_an_outline_that_crosses_itself_is_found():
    eight = np.array([[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]])
    square = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]])
    assert self_crossings(np.stack([square, eight]))[0] == 1
    assert self_crossings(square[None]) is None


def test_an_outline_touches_its_neighbour_where_it_is_higher_than_the_pitch():
    diamond = np.array([[0.0, 0.0], [1.0, -1.0], [2.0, 0.0], [1.0, 1.0]])
    assert touching(diamond[None], 1.9) == 0
    assert touching(diamond[None], 2.1) is None


def test_an_inclined_outline_may_be_higher_than_the_pitch_and_still_clear_its_neighbour():
    flat = np.array([[0.0, 0.0], [4.0, 8.0], [3.9, 8.4], [-0.1, 0.4]])
    assert touching(flat[None], 1.0) is None
    assert touching(flat[None], 0.3) == 0
