"""Native curves of an outline whose points and derivatives are closed forms."""

from dataclasses import dataclass

import numpy as np
import pytest

from bladewright.errors import DesignError
from bladewright.section.arc_length import ArcLength
from bladewright.section.native import knots_for, native_curves
from bladewright.section.outline import Edge, EdgeDerivatives, Joint, Outline

PI = np.pi


@dataclass(frozen=True, kw_only=True)
class Oval(Outline):
    """Parabolic camber v = 4 h u (1 - u), half thickness (T / 2) sin(pi s) across the chord, u = (1 - cos(pi s)) / 2.

    `step` adds step |s - 1/3|^3 to the upper side's and takes it from the lower side's ordinate.
    """

    height: complex
    thickness: complex
    step: float = 0.0
    known: bool = True

    def _edge(self, at_end):
        flip = -1.0 if at_end else 1.0
        s = 1.0 if at_end else 0.0
        off = self.step * np.array([abs(s - 1 / 3) ** 3, 3 * (s - 1 / 3) ** 2 * (2 * s - 1), 6 * abs(s - 1 / 3)])
        starts = []
        for side in (1.0, -1.0):
            point = np.array([[s, side * off[0]]])
            first = np.array([[0.0, side * (self.thickness / 2 * PI * flip + off[1])]])
            second = np.array([[flip * PI**2 / 2, 4 * self.height * PI**2 / 2 + side * off[2]]])
            starts.append(EdgeDerivatives(point, first, second))
        return Edge(kind="blunt" if self.step else "round", upper=starts[0], lower=starts[1])

    @property
    def leading_edge(self):
        return self._edge(at_end=False)

    @property
    def trailing_edge(self):
        return self._edge(at_end=True)

    @property
    def joints(self):
        return (Joint(1 / 3, 2),) if self.step and self.known else ()

    def points(self, s):
        line = self.camber(s)
        off = self.thickness / 2 * np.sin(PI * s) + self.step * np.abs(s - 1 / 3) ** 3
        across = np.stack([np.zeros_like(off), off], axis=-1)
        return line + across, line - across

    def camber(self, s):
        u = (1 - np.cos(PI * s)) / 2
        return np.stack([u + 0 * self.height, 4 * self.height * u * (1 - u)], axis=-1)[None]


OVAL = Oval(height=0.1, thickness=0.12)
S = np.linspace(0.0, 1.0, 777)


@pytest.mark.parametrize("tolerance", [1e-6, 1e-8, 1e-10])
def test_native_sides_lie_within_the_tolerance_of_the_outline(tolerance):
    curves = native_curves(OVAL, tolerance)
    for curve, points in zip(curves, OVAL.points(S), strict=False):
        # compared at five places in each knot span, between which the error may be a little larger
        assert np.max(np.abs(curve(S) - points[0])) < 1.5 * tolerance
    assert len(curves[0].control_points) == len(curves[1].control_points)


def test_a_tolerance_of_a_hundredth_takes_about_twice_the_poles_of_order_six():
    poles = [len(native_curves(OVAL, tolerance)[0].control_points) - 5 for tolerance in (1e-6, 1e-12)]
    # sixth order: a millionth of the error takes ten times the spans, give or take the rounding of each cut
    assert 5.0 < poles[1] / poles[0] < 20.0


def test_round_edges_share_their_points_and_continue_across_to_second_order():
    upper, lower, _ = native_curves(OVAL)
    for place in (0.0, 1.0):
        one, other = (curve.derivatives(np.array([place]), 2) for curve in (upper, lower))
        assert np.array_equal(one[0], other[0])
        # second derivatives are differences of control points over knot spans of 0.02: eps / 0.02^2
        assert one[1] == pytest.approx(-other[1], abs=1e-13)
        assert one[2] == pytest.approx(other[2], abs=1e-10)


def test_the_camber_line_has_the_speed_of_its_length_also_where_the_outline_stands_still():
    camber = native_curves(OVAL)[2]
    speed = np.linalg.norm(camber.derivative(S), axis=-1)
    k = 4 * 0.1
    half = (k * np.sqrt(1 + k * k) + np.arcsinh(k)) / (2 * k)
    # the derivative of a curve within 1e-10 on spans of about 0.05
    assert speed == pytest.approx(half, rel=1e-7)
    x, y = camber(S).T
    assert y == pytest.approx(4 * 0.1 * x * (1 - x), abs=1e-10)


def test_arc_length_is_that_of_a_semicircle_and_its_inverse():
    arc = ArcLength(lambda s: np.stack([np.cos(PI * s**2), np.sin(PI * s**2)], axis=-1), [0.0, 0.4, 1.0])
    assert arc.lengths(S) == pytest.approx(S**2, abs=1e-14)
    assert arc.places(S**2) == pytest.approx(S, abs=1e-8)
    assert arc.lengths(arc.places(S)) == pytest.approx(S, abs=1e-14)


def test_a_known_joint_costs_knots_there_and_an_unknown_one_costs_many():
    kinked = Oval(height=0.1, thickness=0.12, step=0.05)
    upper = native_curves(kinked, 1e-9)[0]
    assert np.sum(upper.knots == 1 / 3) == 3
    unknown = Oval(height=0.1, thickness=0.12, step=0.05, known=False)
    assert len(native_curves(unknown, 1e-9)[0].control_points) > 1.5 * len(upper.control_points)


def test_curves_carry_a_complex_step_at_held_knots():
    carried = native_curves(Oval(height=0.1 + 1e-30j, thickness=0.12), knots=knots_for(OVAL, 1e-10))
    u = (1 - np.cos(PI * S)) / 2
    rates = [np.imag(curve(S)) / 1e-30 for curve in carried]
    # the rate is ten times the camber, which is within 1e-10
    assert rates[0][:, 1] == pytest.approx(4 * u * (1 - u), abs=1e-9)
    assert rates[0] == pytest.approx(rates[1], abs=1e-14)
    assert np.max(np.abs(np.concatenate([rate[:, 0] for rate in rates]))) == 0.0
    assert rates[2][:, 1] == pytest.approx(carried[2](S).real[:, 1] / 0.1, abs=1e-9)


def test_a_tolerance_that_cannot_be_reached_is_refused_with_what_is_reached():
    with pytest.raises(DesignError, match=r"tolerance is 1e-16.*poles.*raise the tolerance"):
        native_curves(OVAL, 1e-16)
