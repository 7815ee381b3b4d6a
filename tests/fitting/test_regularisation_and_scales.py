"""What is held of a design where its cloud says nothing, and how far a parameter may go."""

from dataclasses import replace

import numpy as np
import pytest

import bladewright as bw
from bladewright.designs import Point, limits_at
from bladewright.files.examples import examples
from bladewright.fitting.free_parameters import check_bounds, given_bounds, parameter_range, scales_of
from bladewright.fitting.matching.residuals import (
    BEND_SPREAD,
    CAMBER_SPREAD,
    CHANNEL_SPREAD,
    SPREAD_ABOUT_START,
    TANGENT_SPREAD,
    USUAL_TANGENT,
    regularisation_of,
)
from bladewright.section.checks import UNITS
from machines import example

SECTION = example("turbine-section")
PATHS = tuple(path for path in SECTION.parameters() if path not in ("pitch", "span"))
SIZE = scales_of(SECTION, PATHS, 0.035).size


def rows(changes, start=SECTION):
    """The prior's rows for changed parameters, in the unit of the fields."""
    regularisation = regularisation_of(start, PATHS, SIZE)
    z = np.array([changes.get(path, 0.0) / size for path, size in zip(PATHS, SIZE, strict=True)])
    return regularisation.matrix @ z - regularisation.rhs


def even(above, below):
    """A section whose thicknesses are straight along the chord."""
    names = {"thickness_upper": above, "thickness_lower": below}
    return SECTION.changed({f"{name}[{i}]": values[i] for name, values in names.items() for i in range(5)})


STRAIGHT = even(np.linspace(0.05, 0.13, 5), np.linspace(0.05, 0.13, 5))


def test_a_smooth_design_with_sides_alike_satisfies_its_own_prior():
    np.testing.assert_allclose(rows({}, STRAIGHT), 0.0, atol=1e-12)
    assert np.max(np.abs(rows({}))) > 0.1


def test_an_unusual_tangent_of_a_blade_counts_by_its_spread_and_more_where_few_points_are_independent():
    size = 0.2
    usual = example("centrifugal-impeller").changed("tangent_out", USUAL_TANGENT)
    unusual = usual.changed("tangent_out", USUAL_TANGENT + TANGENT_SPREAD * size)
    for design, share, cost in ((usual, 1.0, 0.0), (unusual, 1.0, 1.0), (unusual, 0.25, 4.0)):
        found = regularisation_of(design, ("tangent_out",), np.array([size]), independent_share=share)
        np.testing.assert_allclose(np.sum(found.rhs**2), cost, atol=1e-24)


def test_a_parameter_that_goes_as_far_as_it_is_near_counts_one():
    at = PATHS.index("stagger")
    found = rows({"stagger": SPREAD_ABOUT_START * SIZE[at]}, STRAIGHT)
    assert np.sum(found**2) == pytest.approx(1.0)


def test_another_straight_law_of_both_sides_costs_its_distance_alone():
    change = {f"{name}[{i}]": 0.01 * (1 + i) for name in ("thickness_upper", "thickness_lower") for i in range(5)}
    found = rows(change, STRAIGHT)
    alone = sum((value / SIZE[PATHS.index(path)] / SPREAD_ABOUT_START) ** 2 for path, value in change.items())
    assert np.sum(found**2) == pytest.approx(alone, rel=1e-9)
    bent = rows(change | {"thickness_upper[2]": 0.0}, STRAIGHT)
    assert np.sum(bent**2) > np.sum(found**2)


def test_the_rows_of_a_changed_design_are_those_of_a_start_there_but_for_nearness():
    change = {"thickness_upper[1]": 0.02, "thickness_lower[3]": -0.01}
    moved = SECTION.changed({path: SECTION.parameters()[path] + value for path, value in change.items()})
    # the first rows hold the start near; the others are of the values themselves
    np.testing.assert_allclose(rows(change)[len(PATHS) :], rows({}, moved)[len(PATHS) :], atol=1e-12)


def test_held_parameters_take_part_with_their_values():
    size = np.array([0.02])
    regularisation = regularisation_of(SECTION, ("thickness_upper[1]",), size)
    above, below = SECTION.thickness_upper, SECTION.thickness_lower
    bends = [above[i] - 2.0 * above[i + 1] + above[i + 2] for i in (0, 1)]
    expected = [*(np.array(bends) / BEND_SPREAD / size), (above[1] - below[1]) / CAMBER_SPREAD / size[0]]
    np.testing.assert_allclose(-regularisation.rhs[1:], expected, rtol=1e-12)
    np.testing.assert_allclose(
        regularisation.matrix[1:, 0], [-2.0 / BEND_SPREAD, 1.0 / BEND_SPREAD, 1.0 / CAMBER_SPREAD], rtol=1e-12
    )


@pytest.mark.parametrize("name", ["turbine-section", "compressor-stator", "radial-turbine", "vki-ls89"])
def test_scales_are_positive_and_every_value_lies_within_them(name):
    blade = example(name)
    paths = tuple(blade.parameters())
    scales = scales_of(blade, paths, float(blade.build().chord))
    values = np.array([blade.parameters()[path] for path in paths])
    assert np.all(scales.size > 0.0)
    assert np.all((scales.low < values) & (values < scales.high))


def test_scales_are_the_same_lengths_in_any_unit():
    lengths = [path for path in PATHS if path in ("axial_chord", "leading_edge_x", "leading_edge_y")]
    changes = {name: 1e-3 * getattr(SECTION, name) for name in ("pitch", "span", *lengths) if getattr(SECTION, name)}
    in_metres = replace(SECTION, length_unit="m", **changes)
    there, here = (scales_of(each, PATHS, 0.035).size for each in (SECTION, in_metres))
    factor = np.where([path in lengths for path in PATHS], UNITS["mm"], 1.0)
    np.testing.assert_allclose(here, there * factor, rtol=1e-12)


def test_bounds_narrow_those_of_the_family():
    scales = scales_of(SECTION, PATHS, 0.035, {"metal_angle_*": (-70.0, 300.0), "stagger": (-32.0, -30.0)})
    own = scales_of(SECTION, PATHS, 0.035)
    at = [PATHS.index(path) for path in ("metal_angle_in", "metal_angle_out", "stagger", "tangent_in")]
    assert scales.low[at].tolist() == [-70.0, -70.0, -32.0, own.low[at[3]]]
    assert scales.high[at].tolist() == [own.high[at[0]], own.high[at[1]], -30.0, own.high[at[3]]]


def test_bounds_of_what_a_structure_lacks_are_passed_over():
    scales, own = (
        scales_of(SECTION, PATHS, 0.035, {"thickness_upper[40]": (0.1, 0.2)}),
        scales_of(SECTION, PATHS, 0.035),
    )
    assert scales.low.tolist() == own.low.tolist()
    assert scales.high.tolist() == own.high.tolist()


@pytest.mark.parametrize(
    ("bounds", "words"),
    [
        ({"staggr": (1.0, 3.0)}, "'staggr'"),
        ({"pitch": (1.0, 3.0)}, "'pitch' is held and has bounds at once"),
        ({"stagger": (100.0, 120.0)}, "the family allows -89 to 89"),
    ],
)
def test_bounds_that_make_no_sense_are_refused(bounds, words):
    with pytest.raises(bw.FitError, match=words) as caught:
        check_bounds(SECTION, PATHS, bounds)
    assert "\n" not in str(caught.value)


def test_an_open_end_is_none_or_infinite():
    given = {"stagger": (None, -30), "tangent_in": (0.1, np.inf)}
    assert given_bounds(given) == {"stagger": (-np.inf, -30.0), "tangent_in": (0.1, np.inf)}


@pytest.mark.parametrize(
    ("bounds", "words"),
    [
        ([("stagger", (1.0, 3.0))], "a mapping from patterns to pairs"),
        ({3: (1.0, 3.0)}, "bounds holds 3"),
        ({"stagger": (1, 2, 3)}, r"the bounds of stagger are \(1, 2, 3\): the lowest and the highest"),
        ({"stagger": 3.0}, "the lowest and the highest"),
        ({"stagger": ("1", "2")}, "the lowest and the highest"),
        ({"stagger": (3.0, 1.0)}, "the first must be below the second"),
        ({"stagger": (np.nan, 1.0)}, "the first must be below the second"),
    ],
)
def test_bounds_of_no_shape_are_refused(bounds, words):
    with pytest.raises(bw.FitError, match=words):
        given_bounds(bounds)


@pytest.mark.parametrize(
    ("shape", "bent"), [((1.0, 1.0, 1.0, 1.0), 0.0), ((0.0, 1.0, 2.0, 3.0), 0.0), ((1, 0, 0, 0), 1.0)]
)
def test_an_edge_may_move_and_tilt_and_its_last_point_does_not_leave_the_others(shape, bent):
    start = example("backswept-impeller")
    edge = tuple(Point(51.0 - 3.0 * i, 100.0 + i**2) for i in range(4))
    start = replace(start, trailing_edge=replace(start.trailing_edge, points=edge))
    paths, size = tuple(f"trailing_edge.points[{i}].r" for i in range(4)), np.full(4, 2.0)
    found = regularisation_of(start, paths, size)
    change = np.array(shape) * BEND_SPREAD
    rows = found.matrix @ change - found.rhs
    # the edge itself is bent, and that costs nothing
    np.testing.assert_allclose(found.rhs, 0.0, atol=1e-12)
    assert np.sum(rows**2) == pytest.approx(np.sum((change / CHANNEL_SPREAD) ** 2) + bent, rel=1e-9)


@pytest.mark.parametrize("name", [name for name in examples() if hasattr(example(name), "section")])
def test_every_parameter_may_go_to_either_end_of_its_scale(name):
    part = example(name).section
    for path, value in part.parameters().items():
        scale, limits = parameter_range(part, path, value, abs(value)), limits_at(part, path)
        if limits is None:
            continue
        assert limits.low <= scale.low < scale.high <= limits.high
        for end in (scale.low, scale.high):
            if np.isfinite(end):
                assert limits.closed or limits.low < end < limits.high
