"""What every passage keeps: shared poles, walls of revolution, periodic boundaries, no fold, the ring's volume."""

import numpy as np
import pytest

from bladewright.domain.knots import BLADE_AT
from bladewright.nurbs.closest import closest_on_curve
from bladewright.nurbs.trimmed import TrimmedSurface

WALLS = ("hub_upper", "hub_lower", "shroud_upper", "shroud_lower")


def net(case, name):
    return case.passage.surfaces[name].control_points


def row_of(wall):
    return 0 if wall.startswith("hub") else -1


def turned(points, by, revolved):
    x, y, z = np.moveaxis(points, -1, 0)
    if not revolved:
        return np.stack([x, y + by, z], axis=-1)
    return np.stack([x, y * np.cos(by) + z * np.sin(by), z * np.cos(by) - y * np.sin(by)], axis=-1)


def pitch(case):
    design = case.blade.design
    return 2.0 * np.pi / design.blade_count if design.blade_count else 1e-3 * design.pitch


def test_neighbouring_faces_share_their_boundary_control_points(case):
    for wall in WALLS:
        row, half = row_of(wall), wall.split("_")[1]
        periodic = net(case, f"periodic_{half}")
        np.testing.assert_array_equal(net(case, wall)[:, -1], periodic[:, row])
        for end, name in ((0, "inlet"), (-1, "outlet")):
            opening = net(case, name)[:, row]
            middle = len(opening) // 2
            mine = opening[middle:] if half == "upper" else opening[middle::-1]
            np.testing.assert_array_equal(net(case, wall)[end], mine)
    for end, name in ((0, "inlet"), (-1, "outlet")):
        np.testing.assert_array_equal(net(case, name)[0], net(case, "periodic_lower")[end])
        np.testing.assert_array_equal(net(case, name)[-1], net(case, "periodic_upper")[end])


def test_walls_carry_the_blades_own_poles_or_meet_along_the_camber_line(case):
    first = len(case.passage.knots.inlet) - 6
    last = len(case.passage.knots.outlet) - 6
    for wall in ("hub", "shroud"):
        upper, lower = (net(case, f"{wall}_{half}")[:, 0] for half in ("upper", "lower"))
        np.testing.assert_array_equal(upper[:first], lower[:first])
        np.testing.assert_array_equal(upper[-last:], lower[-last:])
        if wall in case.blade.surfaces:
            for half, line in (("upper", upper), ("lower", lower)):
                side = net(case, f"blade_{half}")[:, row_of(wall)]
                np.testing.assert_array_equal(line[first - 1 : len(line) - last + 1], side)
        else:
            np.testing.assert_array_equal(upper, lower)


def test_the_blades_sides_are_its_own_with_at_most_more_knots(case):
    u, v = np.meshgrid(np.linspace(0, 1, 37), np.linspace(0, 1, 9))
    for half in ("upper", "lower"):
        own, here = case.blade.surfaces[half], case.passage.surfaces[f"blade_{half}"]
        # knot insertion keeps the shape up to rounding
        np.testing.assert_allclose(here(u, v), own(u, v), rtol=0, atol=1e-14 * case.blade.chord * 10)


def test_every_face_but_the_tip_is_untrimmed(case):
    trimmed = {name for name, face in case.passage.surfaces.items() if isinstance(face, TrimmedSurface)}
    assert trimmed == ({"tip"} if "tip" in case.blade.surfaces else set())


def test_periodic_boundaries_are_one_pitch_apart_pole_for_pole(case):
    lower, upper = net(case, "periodic_lower"), net(case, "periodic_upper")
    moved = turned(lower, pitch(case), case.passage.duct.revolved)
    extent = np.ptp(lower.reshape(-1, 3), axis=0).max()
    np.testing.assert_allclose(upper, moved, rtol=0, atol=1e-12 * extent)


def test_hub_and_shroud_lie_on_the_surfaces_of_revolution_of_the_duct(case):
    random = np.random.default_rng(3)
    for wall in WALLS:
        meridian = case.passage.duct.wall(wall.split("_")[0])
        points = case.passage.surfaces[wall](random.random(400), random.random(400))
        radius = np.hypot(points[:, 1], points[:, 2]) if case.passage.duct.revolved else points[:, 2]
        distance = closest_on_curve(meridian, np.stack([points[:, 0], radius], axis=-1)).distances
        assert np.max(distance) < 1e-7 * case.blade.chord


def test_the_meridians_of_the_duct_continue_those_of_the_channel(case):
    channel = case.passage.duct.channel
    for wall in ("hub", "shroud"):
        points = channel.curve(wall)(np.linspace(0, 1, 41))
        distance = closest_on_curve(case.passage.duct.wall(wall), points).distances
        # a thousandth of what the native walls are allowed
        assert np.max(distance) < 1e-10 * case.blade.chord


def test_no_patch_of_a_wall_folds(case):
    """In random places, by central differences of m and theta, which know nothing of the exact patch."""
    random = np.random.default_rng(5)
    u, v = random.uniform(1e-3, 1 - 1e-3, 4000), random.uniform(1e-3, 1 - 1e-3, 4000)
    u = u[np.min(np.abs(u[:, None] - np.array(BLADE_AT)), axis=1) > 1e-5]
    v = v[: len(u)]
    for wall in WALLS:
        face = case.passage.surfaces[wall]

        def plane(at_u, at_v, face=face):
            x, y, z = np.moveaxis(face(at_u, at_v), -1, 0)
            return (x, np.hypot(y, z), np.arctan2(y, z)) if case.passage.duct.revolved else (x, z, y)

        def slopes(step_u, step_v, plane=plane):
            ahead, behind = plane(u + step_u, v + step_v), plane(u - step_u, v - step_v)
            across = np.arctan2(np.sin(ahead[2] - behind[2]), np.cos(ahead[2] - behind[2]))
            return np.stack([ahead[0] - behind[0], ahead[1] - behind[1]], -1), across

        meridional_u, theta_u = slopes(1e-6, 0.0)
        meridional_v, theta_v = slopes(0.0, 1e-6)
        foot = closest_on_curve(case.passage.duct.wall(wall.split("_")[0]), np.stack(plane(u, v)[:2], -1))
        tangent = case.passage.duct.wall(wall.split("_")[0]).derivative(foot.u)
        along_u, along_v = (np.sum(part * tangent, axis=-1) for part in (meridional_u, meridional_v))
        sign = 1.0 if wall.endswith("upper") else -1.0
        assert np.all(sign * (along_u * theta_v - theta_u * along_v) > 0.0)
        assert case.passage.folds[wall][0] > 0.01


def test_faces_close_up(case):
    # trimmed tips are closed within what their outlines miss, 1e-9 of the chord
    assert case.passage.properties.openness < (1e-10 if "tip" in case.passage.surfaces else 1e-13)


def test_passages_and_blades_fill_the_ring_between_inlet_and_outlet(case):
    count = case.blade.design.blade_count or 1
    filled = count * (case.passage.properties.volume + case.blade.properties.volume)
    assert filled == pytest.approx(case.passage.ring, rel=1e-6)


def test_camber_lines_go_on_at_the_metal_angle_or_turn_to_the_stated_one(case):
    """In (m', theta) the angle of a periodic boundary on hub and shroud, at the blade's edges, inlet and outlet."""
    design, revolved = case.blade.design, case.passage.duct.revolved
    for wall, row, v in (("hub", 0, 0), ("shroud", -1, -1)):
        for piece, inner, outer, angle, asked in (
            ("inlet", BLADE_AT[0] - 1e-9, 0.0, design.metal_angle_in, "inlet_angle"),
            ("outlet", BLADE_AT[1] + 1e-9, 1.0, design.metal_angle_out, "outlet_angle"),
        ):
            metal = angle[v] if isinstance(angle, tuple) else angle
            for u, wanted in ((inner, metal), (outer, case.asked.get(asked, metal))):
                face = case.passage.surfaces["periodic_upper"]
                point = face(u, 0.0 if row == 0 else 1.0)
                slope = face.derivative(u, 0.0 if row == 0 else 1.0)
                if revolved:
                    radius = np.hypot(point[1], point[2])
                    radial = (point[1] * slope[1] + point[2] * slope[2]) / radius
                    swirl = (point[2] * slope[1] - point[1] * slope[2]) / radius
                else:
                    radial, swirl = slope[2], slope[1]
                found = np.degrees(np.arctan2(swirl, np.hypot(slope[0], radial)))
                # the interpolant's slope is one order less accurate than its place
                assert found == pytest.approx(wanted, abs=2e-3), (wall, piece, u)


def test_split_faces_are_pieces_of_the_whole_ones(cascade):
    from bladewright.domain.build import passage

    pieces = passage(cascade.blade, knots=cascade.passage.knots, **cascade.asked, split=True)
    t = np.linspace(0, 1, 11)
    low, high = BLADE_AT
    for name in WALLS:
        for piece, start, end in (("inlet", 0, low), ("blade", low, high), ("outlet", high, 1)):
            whole = cascade.passage.surfaces[name](start + (end - start) * t, 0.4)
            np.testing.assert_allclose(pieces.surfaces[f"{name}_{piece}"](t, 0.4), whole, rtol=0, atol=1e-16)
    assert len(pieces.surfaces) == 24
    assert set(pieces.orientations) == set(pieces.surfaces)
    assert pieces.properties.volume == pytest.approx(cascade.passage.properties.volume, rel=1e-13)


def test_held_knots_give_the_same_passage(rotor):
    from bladewright.domain.build import passage

    again = passage(rotor.blade, knots=rotor.passage.knots)
    for name, face in rotor.passage.surfaces.items():
        np.testing.assert_array_equal(again.surfaces[name].control_points, face.control_points)


def test_the_old_name_of_the_periodic_sector_warns(rotor):
    with pytest.warns(DeprecationWarning, match="use Passage.periodic_sector"):
        old = rotor.passage.sector
    assert old is rotor.passage.periodic_sector
