"""Laws given by values at stations: what lies between, what is refused, what is said."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import bladewright as bw
from bladewright.designs import Stations
from bladewright.errors import DesignError
from bladewright.section import checks
from bladewright.section.laws import Span, joints_of, law_weights, overshoots_of
from bladewright.section.stations import monotone_values, natural_weights
from machines.coarse import ROTOR, SECTION
from machines.sections import EXAMPLES
from machines.stations import TABLE, moved

WAYS = ("natural", "monotone", "linear")
SPAN, VALUES = (0.0, 0.1, 0.35, 0.4, 0.8, 1.0), (1.0, 1.5, 1.6, 4.0, 4.05, 9.0)
V = np.linspace(0.0, 1.0, 1000)


def law(way, values=VALUES, span=SPAN):
    return Stations(span=span, values=values, interpolation=way)


@pytest.mark.parametrize("way", WAYS)
def test_values_are_met_at_their_stations(way):
    assert Span(np.array(SPAN)).values(law(way)) == pytest.approx(VALUES, abs=1e-12)


@pytest.mark.parametrize("way", WAYS)
def test_two_stations_are_a_straight_line(way):
    assert Span(V).values(law(way, (2.0, 5.0), (0.0, 1.0))) == pytest.approx(2.0 + 3.0 * V, abs=1e-14)


@pytest.mark.parametrize("way", WAYS)
def test_weights_are_the_derivatives_by_the_values(way):
    step = 1e-6
    moved = [
        [Span(V).values(law(way, tuple(np.array(VALUES) + sign * step * unit))) for sign in (1.0, -1.0)]
        for unit in np.eye(len(VALUES))
    ]
    central = np.stack([(one - other) / (2.0 * step) for one, other in moved], axis=1)
    assert law_weights(law(way), V) == pytest.approx(central, abs=1e-8)
    assert law_weights(law(way), V).sum(axis=1) == pytest.approx(np.ones(len(V)), abs=1e-14)


def test_a_natural_law_is_scipys_natural_spline():
    assert Span(V).values(law("natural")) == pytest.approx(CubicSpline(SPAN, VALUES, bc_type="natural")(V), abs=1e-13)


@pytest.mark.parametrize("seed", range(40))
def test_monotone_data_stay_monotone(seed):
    draw = np.random.default_rng(seed)
    inner = np.sort(draw.uniform(0.01, 0.99, draw.integers(1, 8)))
    span = (0.0, *inner.tolist(), 1.0)
    values = np.cumsum(draw.exponential(1.0, len(span)) ** 3 * draw.integers(0, 2, len(span)))
    rises = np.diff(monotone_values(span, values, V))
    assert np.min(rises) >= -1e-14 * max(values[-1], 1.0)


def test_a_monotone_law_turns_at_its_stations_alone():
    values = (0.0, 3.0, 2.0, 2.0, 5.0, 4.0)
    found = Span(V).values(law("monotone", values))
    for start, end, low, high in zip(SPAN, SPAN[1:], values, values[1:], strict=False):
        inside = (start <= V) & (end >= V)
        assert np.all(np.diff(found[inside]) * np.sign(high - low) >= -1e-14)


def test_a_monotone_law_is_the_natural_spline_where_that_is_gentle():
    gentle = (0.0, 0.11, 0.36, 0.41, 0.8, 1.0)
    assert Span(V).values(law("monotone", gentle)) == pytest.approx(Span(V).values(law("natural", gentle)), abs=1e-14)


@pytest.mark.parametrize("way", ["natural", "monotone"])
def test_a_law_through_stations_has_two_continuous_derivatives(way):
    """Quintics through six places of each piece, about the station between two."""
    for before, at, after in zip(SPAN, SPAN[1:], SPAN[2:], strict=False):
        sides = []
        for start, end in ((before, at), (at, after)):
            unit = end - start
            t = np.linspace(0.0, 1.0, 6)
            powers = np.linalg.solve(np.vander((start + unit * t - at) / unit), Span(start + unit * t).values(law(way)))
            sides.append(powers[::-1][1:3] / unit ** np.arange(1, 3))
        assert sides[0] == pytest.approx(sides[1], rel=1e-10, abs=1e-10 * np.ptp(VALUES) / unit**2)


def test_a_linear_law_has_a_crease_at_each_inner_station():
    assert list(joints_of(law("linear"))) == [(v, 0) for v in SPAN[1:-1]]
    assert list(joints_of(law("natural"))) == [(v, 2) for v in SPAN[1:-1]]


def test_an_overshoot_is_named_with_place_and_amount():
    found, spline = list(overshoots_of(law("natural"), "stagger")), CubicSpline(SPAN, VALUES, bc_type="natural")
    passed = []
    for start, end in pairwise(SPAN):
        ends, inside = spline([start, end]), spline(np.linspace(start, end, 2001))
        passed += [
            amount for amount in (np.max(inside) - np.max(ends), np.min(ends) - np.min(inside)) if amount > 0.008
        ]
    assert sorted(each.amount for each in found) == pytest.approx(sorted(passed), rel=1e-4)
    assert [spline(each.v, 1) for each in found] == pytest.approx([0.0] * len(found), abs=1e-10)
    assert not list(overshoots_of(law("monotone"), "stagger"))
    assert not list(overshoots_of(TABLE, "metal_angle_out"))


def test_limits_are_kept_between_stations_too():
    steep = law("natural", (0.0, 0.0, 89.0, 89.0, 0.0, 0.0))
    with pytest.raises(DesignError, match=r'stagger at v = 0\.\d+ is \d+.* between its stations.*"monotone"'):
        ROTOR.changed("stagger", steep)
    assert ROTOR.changed("stagger", law("monotone", steep.values))


REFUSED = {
    "stagger.span[1] is 0 after 0": {"span": [0.0, 0.0, 1.0], "values": [1.0, 2.0, 3.0]},
    "stagger.span[2] is 0.4 after 0.6": {"span": [0.0, 0.6, 0.4, 1.0], "values": [1.0, 2.0, 3.0, 4.0]},
    "stagger.span runs from 0.1 to 1": {"span": [0.1, 1.0], "values": [1.0, 2.0]},
    "stagger.span runs from 0 to 0.9": {"span": [0.0, 0.9], "values": [1.0, 2.0]},
    "stagger.span has 1 entries": {"span": [0.0], "values": [1.0]},
    "stagger.values has 3 entries for the 2 stations of its span": {"span": [0.0, 1.0], "values": [1.0, 2.0, 3.0]},
    "stagger.interpolation is 'naturally'": {"span": [0.0, 1.0], "values": [1.0, 2.0], "interpolation": "naturally"},
    "stagger.value does not exist; did you mean 'values'?": {"span": [0.0, 1.0], "value": [1.0]},
    "stagger.values is None": {"span": [0.0, 1.0]},
    "stagger.values[1] is 'x': a number": {"span": [0.0, 1.0], "values": [1.0, "x"]},
    "stagger.values[0] is nan": {"span": [0.0, 1.0], "values": [float("nan"), 1.0]},
}


@pytest.mark.parametrize("message", REFUSED)
def test_what_is_no_law_through_stations_is_refused(message):
    with pytest.raises(DesignError) as caught:
        checks.law("stagger", REFUSED[message])
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_table_in_place_of_stations_is_taken():
    assert ROTOR.changed("stagger", {"span": [0, 1], "values": [10, 20]}).stagger == Stations(
        span=(0.0, 1.0), values=(10.0, 20.0)
    )


def test_a_section_in_its_plane_has_no_stations():
    for design, path in ((SECTION, "thickness_upper[0]"), (EXAMPLES["naca-2412"].design, "section.thickness")):
        with pytest.raises(DesignError, match=r"given at stations.*a single section takes a number"):
            design.changed(path, moved(TABLE, lambda _: 0.1))
    with pytest.raises(DesignError, match=r"stagger is Stations.*a number is needed"):
        SECTION.changed("stagger", TABLE)


def test_a_section_with_a_law_is_not_refined():
    part = EXAMPLES["suction and pressure side of a stator"].design.section
    with pytest.raises(DesignError, match="stagger_angle belongs to a law along the span"):
        part.changed("stagger_angle", TABLE).refined(1)


def test_a_law_of_stations_has_paths_to_its_values():
    design = ROTOR.changed("metal_angle_out", TABLE)
    assert design.parameters()["metal_angle_out.values[2]"] == -34.0
    assert design.changed("metal_angle_out.values[2]", -30.0).metal_angle_out.values[2] == -30.0
    assert "metal_angle_out.span[1]" not in design.parameters()
    with pytest.raises(DesignError, match=r"given at stations; write \.values\[1\]"):
        design.changed("metal_angle_out[1]", 3.0)
    assert bw.designs.unit_at(design, "metal_angle_out.values[2]") == "deg"


def test_natural_weights_carry_a_batch_of_steps():
    batch = tuple(np.array([value, value + 1e-30j * i]) for i, value in enumerate(VALUES))
    found = Span(V).values(law("natural", batch))
    assert np.imag(found[1]) / 1e-30 == pytest.approx(natural_weights(SPAN, V) @ np.arange(6.0), abs=1e-13)
