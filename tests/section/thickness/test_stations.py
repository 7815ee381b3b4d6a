"""The map from s to the chord: it rises whatever the joints, meets them, and is even about a round edge."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bladewright.section.chord_map import Breakpoint, ChordMap

S = np.linspace(0.0, 1.0, 401)


def stations(u, *, leading=True, trailing=True, bend=None) -> ChordMap:
    """Joints of an ellipse, the maximum, and an ellipse, at u."""
    places = zip(u, (0.02, 0.4, 0.99), (1, 2, 1), strict=True)
    breaks = [Breakpoint(np.array([at]), np.array([1.0 - at]), derivatives, sigma) for at, sigma, derivatives in places]
    return ChordMap(breaks, leading_round=leading, trailing_round=trailing, bend=bend)


@given(
    first=st.floats(1e-5, 0.3),
    middle=st.floats(0.05, 0.95),
    last=st.floats(1e-5, 0.3),
    leading=st.booleans(),
    trailing=st.booleans(),
)
def test_the_map_rises_through_any_joints(first, middle, last, leading, trailing):
    joints = (first, first + middle * (1.0 - first - last), 1.0 - last)
    found = stations(joints, leading=leading, trailing=trailing)
    u = found.u(S).value[0]
    assert np.all(np.diff(u) > 0.0)
    np.testing.assert_allclose(u[[0, -1]], [0.0, 1.0], atol=1e-14)
    at = np.array([joint.s for joint in found.joints])
    np.testing.assert_allclose(found.u(at).value[0], joints, rtol=1e-12)


@given(bend=st.floats(-100.0, 100.0))
def test_the_map_rises_however_skewed_and_takes_the_second_derivative_of_root_and_bend_away(bend):
    found = stations((0.2, 0.4, 0.98), bend=np.array([bend]))
    piece = found.place(0, np.array([0.0, 0.01, 0.02, 0.05, 0.08]), 2)
    assert np.all(piece.u.coefficients[1][0, 1:] > 0.0)
    half = piece.root + bend * piece.u
    root_slope = piece.root.coefficients[1][0, 0]
    assert abs(half.coefficients[2][0, 0]) < 1e-12 * (1.0 + abs(bend)) * root_slope**2
    # two derivatives stay at the joint where the skew ends
    before = [
        piece_u.coefficients for piece_u in (found.place(0, found.ends[:1], 2).u, found.place(1, found.ends[:1], 2).u)
    ]
    np.testing.assert_allclose(
        [each[0, 0] for each in before[0][:2]], [each[0, 0] for each in before[1][:2]], rtol=1e-9
    )


@pytest.mark.parametrize("s", [0.01, 0.05])
def test_at_a_round_edge_the_chord_fraction_is_even_and_its_root_odd(s):
    found = stations((0.03, 0.4, 0.98))
    there, back = (found.place(0, np.array([each]), 0) for each in (s, -s))
    assert there.u.value == back.u.value
    assert there.root.value == -back.root.value
    np.testing.assert_allclose(there.root.value**2, there.u.value, rtol=1e-14)
    there, back = (found.place(3, np.array([each]), 0) for each in (1.0 - s, 1.0 + s))
    np.testing.assert_allclose(there.rest.value, back.rest.value, rtol=1e-12)
    np.testing.assert_allclose(there.rest_root.value, -back.rest_root.value, rtol=1e-12)


def test_joints_at_their_usual_places_leave_the_cosine_map():
    u = stations((0.02, 0.4, 0.99)).u(S).value[0]
    np.testing.assert_allclose(u, 0.5 * (1.0 - np.cos(np.pi * S)), atol=1e-15)
