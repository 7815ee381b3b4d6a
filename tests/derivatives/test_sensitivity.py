"""Derivatives of any quantity: closed forms, finite differences, held knots, and what cannot be differentiated."""

import math

import numpy as np
import pytest

import bladewright as bw
from bladewright.blade.native.properties import blade_moments
from bladewright.derivatives.complex_step import stepped, varied
from bladewright.designs import unit_at
from bladewright.errors import DerivativeError, DesignError
from bladewright.nurbs.curvature import surface_curvature
from machines import built
from machines.coarse import CASCADE, CLEARED, ROTOR, SECTION
from machines.families import FAMILIES

U, V = np.linspace(0.0, 1.0, 7)[:, None], np.linspace(0.0, 1.0, 5)
MILLIMETRE = 1e-3


def lengths_of(design):
    return [path for path in design.parameters() if unit_at(design, path) == "length"]


@pytest.mark.parametrize("name", FAMILIES)
def test_a_design_that_carries_a_step_is_the_one_that_is_checked_again(name):
    for path, value in FAMILIES[name].parameters().items():
        carrying = value + 1e-30j
        assert FAMILIES[name].stepped(path, carrying) == FAMILIES[name].changed(path, carrying) != FAMILIES[name]


def central(design, base, path, quantity, step):
    """A central difference of the fourth order, of two steps, at the knots of `base`."""
    value = design.parameters()[path]
    moves = [{path: value + size * step} for size in (1.0, -1.0, 2.0, -2.0)]
    found = [quantity(each) for each in varied(design, base, moves)]
    return (8.0 * (found[0] - found[1]) - (found[2] - found[3])) / (12.0 * step)


def test_points_are_homogeneous_of_degree_one_in_all_lengths_together(design, blade):
    # Euler: everything else is an angle or a proportion
    found = bw.sensitivity(design, lambda blade: blade.surfaces["upper"](U, V), knots=blade.knots)
    total = sum(found[path] * design.parameters()[path] for path in lengths_of(design))
    assert total == pytest.approx(blade.surfaces["upper"](U, V), abs=1e-11 * blade.chord)


def test_volume_and_inertia_are_homogeneous_of_degree_three_and_five(design, blade):
    def quantity(blade):
        return np.append(blade.properties.inertia, blade.properties.volume)

    found = bw.sensitivity(design, quantity, knots=blade.knots, free=lengths_of(design))
    total = sum(found[path] * design.parameters()[path] for path in lengths_of(design))
    inertia, volume = blade.properties.inertia, blade.properties.volume
    # but for what leaves through the gap between walls and sides, some 1e-9 of the chord wide
    assert total[-1] == pytest.approx(3.0 * volume, rel=1e-8)
    assert total[:-1] == pytest.approx(5.0 * inertia.ravel(), abs=1e-8 * np.abs(inertia).max())


def test_moving_the_whole_channel_along_the_axis_moves_every_point_with_it(design, blade):
    free = [path for path in design.parameters() if path.startswith("channel.") and path.endswith(".x")]
    found = bw.sensitivity(design, lambda blade: blade.surfaces["lower"](U, V), knots=blade.knots, free=free)
    total = sum(found.values())
    assert total == pytest.approx(np.broadcast_to([MILLIMETRE, 0.0, 0.0], total.shape), abs=1e-15)


def test_the_leading_edge_s_theta_turns_the_blade():
    blade = built(ROTOR)
    found = bw.sensitivity(ROTOR, lambda blade: blade.surfaces["upper"](U, V), free="leading_edge_theta[*]")
    # y = r sin(theta), z = r cos(theta), and a law's basis functions sum to one
    point = blade.surfaces["upper"](U, V)
    turned = np.radians(1.0) * np.stack([0.0 * point[..., 0], point[..., 2], -point[..., 1]], axis=-1)
    assert sum(found.values()) == pytest.approx(turned, abs=1e-14)


def test_the_volume_of_a_prismatic_blade_grows_with_its_height():
    design = bw.prismatic(SECTION, span=50.0)
    top = ["channel.leading_edge[1].r", "channel.trailing_edge[1].r"]
    found = bw.sensitivity(design, lambda blade: blade.properties.volume, free=top)
    assert sum(found.values()) == pytest.approx(MILLIMETRE * SECTION.build().area, rel=1e-6)


def test_a_section_s_area_grows_with_the_square_of_its_chord_and_keeps_its_place():
    area = bw.sensitivity(SECTION, lambda section: section.area)
    assert tuple(area) == tuple(SECTION.parameters())
    assert area["axial_chord"] == pytest.approx(2.0 * SECTION.build().area / SECTION.axial_chord, rel=1e-12)
    assert area["leading_edge_y"] == pytest.approx(0.0, abs=1e-17)
    centroid = bw.sensitivity(SECTION, lambda section: section.centroid, free=["leading_edge_?"])
    assert centroid["leading_edge_x"] == pytest.approx([MILLIMETRE, 0.0], abs=1e-15)
    assert centroid["leading_edge_y"] == pytest.approx([0.0, MILLIMETRE], abs=1e-15)


def control_points_of_ends(blade):
    ends = [blade.surfaces[name] for name in blade.design.ends]
    walls = [end.surface.control_points.ravel() for end in ends]
    return np.concatenate([*walls, *[curve.control_points.ravel() for end in ends for curve in end.boundary]])


QUANTITIES = {
    "normals": lambda blade: blade.surfaces["upper"].normal(U[1:-1], V),
    "curvature": lambda blade: surface_curvature(blade.surfaces["upper"], 0.4, V).mean,
    "control points of ends": control_points_of_ends,
    "area": lambda blade: blade.properties.area,
    "centroid": lambda blade: blade.properties.centroid,
    "a section's chord": lambda blade: blade.section(0.4).chord,
    "throat": lambda blade: bw.throat(blade).area,
}


@pytest.mark.parametrize(
    ("design", "path", "step"),
    [(CLEARED, "channel.hub[0].r", 0.05), (CASCADE, "channel.trailing_edge[0].x", 0.05), (CASCADE, "stagger[0]", 0.05)],
    ids=["wall", "corner", "turning"],
)
def test_any_quantity_has_the_derivative_that_differences_approach(design, path, step):
    base = built(design)
    for name, quantity in QUANTITIES.items():
        found = bw.sensitivity(design, quantity, free=[path], knots=base.knots)[path]
        expected = central(design, base, path, quantity, step)
        size = np.abs(expected).max()
        # truncation and rounding over the step, as for a parameter of some ten units
        assert size > 0.0, name
        assert found == pytest.approx(expected, abs=1e-8 * size), name


def test_the_moments_that_carry_a_step_are_those_of_the_quadrature(design, blade):
    paths = ["stagger[1]", "channel.leading_edge[1].r", "thickness_lower[1]"]
    for carrying in stepped(design, blade, paths):
        exact = np.imag(blade_moments(carrying.surfaces, blade.orientations, revolved=blade.exact.mapping.revolved))
        assert np.imag(carrying.moments()) == pytest.approx(exact, rel=1e-10)


def test_the_given_knots_are_held():
    knots = ROTOR.build().knots
    finer = ROTOR.changed("tolerance", 1e-5).build().knots
    assert finer.poles != knots.poles
    found = bw.sensitivity(ROTOR, lambda blade: blade.surfaces["upper"].control_points, free="stagger[0]", knots=finer)
    assert found["stagger[0]"].shape == (*finer.poles, 3)


def test_a_quantity_that_does_not_depend_on_a_parameter_has_a_derivative_of_zero():
    found = bw.sensitivity(ROTOR, lambda blade: blade.surfaces["hub"].surface(0.5, 0.5), free="stagger*")
    assert all(np.array_equal(value, np.zeros(3)) for value in found.values())


LOSING = {
    "real parts": lambda blade: np.real(blade.properties.volume),
    "a magnitude": lambda blade: np.abs(blade.surfaces["upper"](0.5, 0.5)),
    "the mean chord": lambda blade: blade.chord,
}


@pytest.mark.parametrize("quantity", LOSING.values(), ids=LOSING)
def test_a_quantity_that_loses_the_step_is_refused(quantity):
    with pytest.raises(DerivativeError, match=r"is real .* on channel.leading_edge\[0\].x and .* others, yet changes"):
        bw.sensitivity(ROTOR, quantity, free="channel.*")


FAILING = {
    "float": lambda blade: float(blade.properties.volume),
    "math": lambda blade: math.sqrt(blade.properties.volume),
}


@pytest.mark.parametrize("quantity", FAILING.values(), ids=FAILING)
def test_a_quantity_that_cannot_take_complex_numbers_is_told_how_to(quantity):
    with pytest.raises(DerivativeError, match=r"fails with a complex step on stagger\[0\].*sqrt\(sum\(x \* x\)\)"):
        bw.sensitivity(ROTOR, quantity, free="stagger[0]")


@pytest.mark.parametrize("value", ["text", None, [[1.0], [1.0, 2.0]], {"volume": 1.0}])
def test_a_quantity_that_is_no_array_is_refused(value):
    with pytest.raises(DerivativeError, match="a number or an array of numbers is needed"):
        bw.sensitivity(ROTOR, lambda _: value, free="stagger[0]")


def test_a_derivative_that_is_not_finite_names_its_parameter():
    def singular(blade):
        away = blade.properties.volume - blade.properties.volume.real
        return np.exp(1e3 + away / (blade.properties.volume.real * 1e-40))

    with pytest.raises(DerivativeError, match=r"by stagger\[0\] is not finite: .* singular"), np.errstate(all="ignore"):
        bw.sensitivity(ROTOR, singular, free="stagger[0]")


def test_patterns_choose_parameters_and_brackets_stand_for_themselves():
    def chosen(*free):
        return list(bw.sensitivity(SECTION, lambda section: section.area, free=list(free)))

    assert chosen("weights_upper[*]") == ["weights_upper[0]", "weights_upper[1]", "weights_upper[2]"]
    assert chosen("thickness_upper[1]", "axial_chord") == ["axial_chord", "thickness_upper[1]"]
    assert chosen("tangent_??") == ["tangent_in"]


@pytest.mark.parametrize(
    ("pattern", "hint"),
    [
        ("stager[0]", r"did you mean 'stagger\[0\]'"),
        ("stagger", r"stagger\[0\].*write 'stagger\*'"),
        ("[a-z]*", "known are leading"),
    ],
)
def test_a_pattern_without_a_parameter_is_refused_with_the_nearest(pattern, hint):
    with pytest.raises(DesignError, match=hint):
        bw.sensitivity(ROTOR, lambda blade: blade.properties.volume, free=[pattern])
