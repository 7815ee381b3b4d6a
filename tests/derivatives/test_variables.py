"""A design as a vector: scaled, bounded, driven by scipy in ten lines."""

import doctest

import numpy as np
import pytest
from scipy.optimize import NonlinearConstraint, minimize

import bladewright as bw
from bladewright.derivatives import sensitivity, variables
from bladewright.errors import DesignError
from machines.coarse import CASCADE, ROTOR, SECTION


@pytest.mark.parametrize("module", [variables, sensitivity], ids=lambda module: module.__name__)
def test_the_examples_in_the_docstrings_run(module):
    found = doctest.testmod(module)
    assert found.attempted > 2
    assert found.failed == 0


def test_a_vector_is_the_values_over_their_scales_and_comes_back_as_the_design():
    space = bw.variables(ROTOR, free=["stagger[*]", "thickness_lower[?]", "channel.hub[0].*"])
    assert space.paths[:5] == tuple(f"stagger[{i}]" for i in range(5))
    values = ROTOR.parameters()
    assert space.x0 * space.scale == pytest.approx([values[path] for path in space.paths], rel=1e-15)
    assert space.design(space.x0).parameters() == pytest.approx(values, rel=1e-15)
    x = space.x0 + 0.01
    assert space.vector(space.design(x)) == pytest.approx(x, rel=1e-14)


def test_scales_are_an_angle_of_ten_degrees_a_tenth_of_the_chord_and_the_largest_of_a_proportion():
    space = bw.variables(CASCADE, free=["stagger[0]", "channel.hub[0].x", "thickness_upper*", "tangent_out[*]"])
    scale = dict(zip(space.paths, space.scale, strict=True))
    assert scale["stagger[0]"] == 10.0
    assert scale["channel.hub[0].x"] == pytest.approx(0.1 * CASCADE.build().chord / 1e-3)
    assert scale["thickness_upper[1][0]"] == 0.06
    assert scale["tangent_out[0]"] == 0.45
    given = bw.variables(CASCADE, free="stagger*", scale={"stagger[0]": 2.0})
    assert list(given.scale) == [2.0, 10.0]


def test_bounds_are_absolute_and_changes_are_counted_from_the_design():
    space = bw.variables(
        ROTOR,
        free=["stagger[0]", "thickness_lower*", "metal_angle_in[0]"],
        bounds={"thickness_lower*": (0.01, 0.1)},
        changes={"stagger*": (-5.0, 10.0)},
    )
    found = {
        path: (low * scale, high * scale)
        for path, (low, high), scale in zip(space.paths, space.bounds, space.scale, strict=True)
    }
    assert found["stagger[0]"] == pytest.approx((10.0, 25.0))
    assert found["thickness_lower[1]"] == pytest.approx((0.01, 0.1))
    assert found["metal_angle_in[0]"] == (-np.inf, np.inf)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"bounds": {"stagger[0]": (20.0, 30.0)}}, r"stagger\[0\] is 15: it lies outside its bounds, 20 to 30"),
        ({"bounds": {"stagger*": (0.0, 90.0), "stagger[0]": (0.0, 20.0)}}, r"stagger\[0\] is matched by two patterns"),
        ({"bounds": {"stagger[0]": (0, 20)}, "changes": {"stagger*": (-1, 1)}}, "bounded twice"),
        ({"bounds": {"thickness*": (0.0, 1.0)}}, "'thickness.*' is no parameter that is free here"),
        ({"scale": {"stagger[0]": 0.0}}, r"the scale of stagger\[0\] is 0.0: it must be positive"),
        ({"free": []}, "no parameter is free"),
    ],
)
def test_bounds_and_scales_that_make_no_sense_are_refused(options, message):
    with pytest.raises(DesignError, match=message):
        bw.variables(ROTOR, **{"free": "stagger*"} | options)


def test_an_objective_s_gradient_is_the_sensitivity_by_x():
    space = bw.variables(ROTOR, free=["stagger[1]", "thickness_upper[1][*]"])

    def quantity(blade):
        return 1e6 * blade.properties.centroid

    objective = space.objective(quantity)
    value, jacobian = objective(space.x0)
    found = bw.sensitivity(ROTOR, quantity, free=space.paths, knots=space.knots)
    assert value == pytest.approx(1e6 * ROTOR.build().properties.centroid)
    assert jacobian.shape == (3, len(space.paths))
    assert jacobian == pytest.approx(space.gradient(found))
    with pytest.raises(DesignError, match=r"derivative by thickness_upper\[1\]\[0\] is missing"):
        space.gradient({"stagger[1]": 1.0})


def test_knots_are_held_in_a_search_and_refined_on_a_restart():
    space = bw.variables(ROTOR, free="stagger*")
    x = space.x0 + np.array([0.0, 0.2, 0.0, 0.0, 0.0])
    assert space.build(x).knots is space.knots
    again = space.restarted(x)
    assert again.x0 == pytest.approx(x)
    assert again.knots.poles == space.design(x).build().knots.poles


def test_scipy_brings_a_section_to_an_area_with_the_least_change_in_ten_lines():
    space = bw.variables(SECTION, free=["thickness*", "axial_chord"], bounds={"thickness*": (0.02, 0.2)})
    area, x0 = space.objective(lambda section: 1e4 * section.area), space.x0
    target = 1.1 * area.value(x0)
    found = minimize(
        lambda x: (((x - x0) ** 2).sum(), 2.0 * (x - x0)),
        x0,
        jac=True,
        bounds=space.bounds,
        constraints=NonlinearConstraint(area.value, target, target, jac=area.jacobian),
        method="SLSQP",
        tol=1e-12,
    )
    assert found.success
    assert 1e4 * space.build(found.x).area == pytest.approx(target, rel=1e-8)
    # at the least change, the step is along the gradient: inside the bounds nothing else holds it
    slope = area.jacobian(found.x)
    step = found.x - x0
    assert step @ slope / np.sqrt((step @ step) * (slope @ slope)) == pytest.approx(1.0, abs=1e-5)
