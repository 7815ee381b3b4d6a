"""What every thickness law keeps: edges, smoothness at its joints, exact derivatives, every parameter at work."""

import numpy as np
import pytest

from bladewright.section.laws import Span
from bladewright.section.thickness.law import ThicknessLaw
from machines.thickness_laws import LAWS

SPAN = Span(np.array([0.0, 0.35, 1.0]))
PLACES = np.linspace(0.0, 1.0, 41)
PARAMETERS = [(name, path) for name, law in LAWS.items() for path in law.parameters()]


@pytest.fixture(params=LAWS, name="law")
def each_law(request) -> ThicknessLaw:
    return LAWS[request.param]


def both(law: ThicknessLaw, s=PLACES) -> np.ndarray:
    """u and half thickness, one array (2, ..., m, k)."""
    thickness = law.at(SPAN)
    return np.stack(np.broadcast_arrays(thickness.u(s), thickness.half(s)))


def test_the_chord_fraction_rises_from_0_to_1(law):
    u = law.at(SPAN).u(np.linspace(0.0, 1.0, 2001))
    np.testing.assert_allclose(u[..., 0], 0.0, atol=1e-15)
    np.testing.assert_allclose(u[..., -1], 1.0, atol=1e-15)
    assert np.all(np.diff(u, axis=-1) > 0.0)


def test_the_half_thickness_is_zero_at_an_edge_unless_it_is_blunt(law):
    thickness = law.at(SPAN)
    for s, kind in ((0.0, thickness.leading), (1.0, thickness.trailing)):
        assert np.all((thickness.half(np.array([s])) > 1e-4) == (kind == "blunt"))


def test_places_by_s_and_by_chord_fraction_are_the_same(law):
    thickness = law.at(SPAN)
    # near a round edge the root of u is off by the square root of the rounding of u
    s = np.linspace(0.01, 0.99, 50)
    np.testing.assert_allclose(thickness.half_at(thickness.u(s)), thickness.half(s), atol=1e-13)


def test_the_maximum_is_as_asked_and_where_asked(law):
    thickness = law.at(SPAN)
    at, maximum = SPAN.values(law.maximum_thickness_at), 0.5 * SPAN.values(law.maximum_thickness)
    if law.law == "wennerstrom":  # which counts from one ellipse to the other
        ends = [0.0 if name == "sharp" else None for name in (law.leading_edge, law.trailing_edge)]
        joints = [joint.s for joint in thickness.joints]
        place = thickness.u(np.array([joints[1] if len(joints) == 3 or ends[0] is None else joints[0]]))[..., 0]
        u = thickness.u(np.array([0.0, *joints, 1.0]))
        low = u[..., 1] if law.leading_edge == "elliptic" else u[..., 0]
        high = u[..., -2] if law.trailing_edge == "elliptic" else u[..., -1]
        np.testing.assert_allclose((place - low) / (high - low), np.broadcast_to(at, place.shape), rtol=1e-13)
        at = place
    half = np.stack([thickness.half_at(each[:, None])[..., 0] for each in (at, at - 1e-4, at + 1e-4)])
    middle = np.broadcast_to(maximum, half[0].shape)
    np.testing.assert_allclose(half[0], middle, rtol=1e-12)
    assert np.all(half[1:] < half[0])
    np.testing.assert_allclose(np.max(thickness.half(np.linspace(0.0, 1.0, 801)), axis=-1), middle[..., 0:], rtol=1e-4)


def test_derivatives_are_those_of_the_values(law):
    thickness, step = law.at(SPAN), 1e-5
    joints = np.array([0.0, *[joint.s for joint in thickness.joints], 1.0])
    s = (joints[:-1, None] + np.diff(joints)[:, None] * np.array([0.2, 0.7])).ravel()
    low, now, high = (
        np.stack(np.broadcast_arrays(*thickness.derivatives(each, 5))) for each in (s - step, s, s + step)
    )
    change = (high - low)[..., :3] / (2.0 * step)
    # a central difference is off by a sixth of step^2 times the derivative two higher, and by rounding over the step
    truncation = step**2 / 6.0 * np.abs(now[..., 3:])
    size = np.max(np.abs(now[..., :3]), axis=-2, keepdims=True)
    assert np.all(np.abs(change - now[..., 1:4]) <= 2.0 * truncation + 1e-15 / step * (10.0 + size))


def test_as_many_derivatives_are_continuous_at_a_joint_as_it_says_and_no_more(law):
    thickness = law.at(SPAN)
    for joint in thickness.joints:
        near = 1e-9
        u, half = thickness.derivatives(np.array([joint.s - near, joint.s + near]), 4)
        found = np.stack(np.broadcast_arrays(u, half))
        jump = np.abs(found[..., 1, :] - found[..., 0, :])
        kept = joint.derivatives + 1
        # what changes over 2e-9 by the next derivative, which is below 1e4 here
        assert np.all(jump[..., :kept] < 1e-4)
        assert np.max(jump[..., kept]) > 1e-3


def test_both_sides_meet_at_a_round_edge_with_opposite_first_and_equal_second_derivatives(law):
    thickness = law.at(SPAN)
    for s, kind, sign in ((0.0, thickness.leading, 1.0), (1.0, thickness.trailing, -1.0)):
        u, half = (each[..., 0, :] for each in thickness.derivatives(np.array([s])))
        if kind == "round":
            np.testing.assert_allclose(u[..., 1], 0.0, atol=1e-13)
            np.testing.assert_allclose(half[..., 2], 0.0, atol=1e-12)
            assert np.all(sign * half[..., 1] > 0.0)
            assert np.all(sign * u[..., 2] > -1e-12)
        else:
            assert np.all(u[..., 1] > 0.1)


@pytest.mark.parametrize(("name", "path"), PARAMETERS)
def test_a_complex_step_is_the_central_difference_and_no_parameter_is_dead(name, path):
    law, step = LAWS[name], 1e-5
    value = law.parameters()[path]
    exact = np.imag(both(law.changed(path, value + 1e-30j))) / 1e-30
    if path == "trailing_edge_curvature" and value == 0.0:  # at the lowest it can be
        low, high, apart = both(law), both(law.changed(path, step)), step
        assert np.max(np.abs((high - low) / apart - exact)) < 1e-4 * np.max(np.abs(exact))
    else:
        low, high = (both(law.changed(path, value + each)) for each in (-step, step))
        # second order in the step; the shapes change over about a tenth of a parameter
        assert np.max(np.abs((high - low) / (2.0 * step) - exact)) < 3e-5 * np.max(np.abs(exact))
    assert np.max(np.abs(exact)) > 1e-4


def test_a_batch_of_values_gives_a_batch_of_sections(law):
    path = next(iter(path for path in law.parameters() if path.startswith("maximum_thickness")))
    value = law.parameters()[path]
    batch = law.changed(path, np.array([value, 1.03 * value]))
    one = both(law.changed(path, 1.03 * value))
    np.testing.assert_allclose(both(batch)[:, 1], np.broadcast_to(one, both(batch)[:, 1].shape), rtol=0, atol=1e-15)
