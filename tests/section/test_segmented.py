"""Segmented airfoils: joints as continuous as asked for, whatever the scale factors, and morphs that keep them so."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from bladewright.errors import DesignError
from bladewright.numerics.elementary import cross2
from bladewright.nurbs.basis import basis, breaks
from bladewright.section.laws import Span
from bladewright.section.outline import Joint
from bladewright.section.segmented.outline import CUTS
from bladewright.section.segmented.parts import Morph, Nose, Segment, SegmentJoint
from bladewright.section.segmented.segment import DEGREE, SegmentEnd, control_points, segment_knots
from bladewright.section.segmented.skin import SEGMENTS
from machines.segmented import AIRFOILS, FULL, MIXED, REDUCED, SKINNED, airfoil_of

SPAN = Span(np.zeros(1))
SIDES = ("upper", "lower")
ANGLES = [(-20.0, -50.0), (-20.0, 20.0), (4.0, -15.0), (8.08, 12.6), (30.0, -50.0), (30.0, 20.0)]
"""[deg] of leading and trailing edge: the corners of the paper's search, its example and its result"""


def ends_of(controls):
    """Point, first and second derivative (3, 2) by its own parameter at both ends of a segment."""
    knots = segment_knots(len(controls))
    return [np.array([(basis(knots, DEGREE, [u], k) @ controls)[0] for k in range(3)]) for u in (0.0, 1.0)]


def slope_and_curvature(end):
    _, first, second = end
    return np.degrees(np.arctan2(first[1], first[0])), cross2(first, second) / np.linalg.norm(first) ** 3


def segments(part):
    """Control points (n, 2) of the segments of both sides, from the leading to the trailing edge."""
    return [[each[0] for each in side.controls] for side in part.outline(SPAN).sides]


@pytest.mark.parametrize("scale", [0.3, 1.0, 2.5])
@pytest.mark.parametrize("inner", [1, 3])
def test_end_control_points_give_the_tangent_times_sf_and_the_curvature_times_its_square(scale, inner):
    rng = np.random.default_rng(3)
    vectors = rng.normal(size=(2, 3, 2))
    ends = [
        SegmentEnd(point=p[None], tangent=t[None], curvature=c[None], scale=np.array([scale])) for p, t, c in vectors
    ]
    controls = control_points(ends[0], rng.normal(size=(1, inner, 2)), ends[1])[0]
    assert len(controls) == 6 + inner
    powers = np.array([1.0, scale, scale**2])[:, None]
    for found, given in zip(ends_of(controls), vectors, strict=True):
        assert found == pytest.approx(powers * given, abs=1e-12)


def test_knots_are_uniform():
    assert np.diff(breaks(segment_knots(7))) == pytest.approx(0.25)
    assert np.diff(breaks(segment_knots(5))) == pytest.approx(0.5)


@pytest.mark.parametrize("scales", [{}, {"front_scale": 0.4, "rear_scale": 1.7}])
def test_joints_have_the_heights_angles_and_curvatures_asked_for_whatever_the_scale_factors(scales):
    box = {side: replace(getattr(REDUCED, side).central_box, **scales) for side in SIDES}
    part = replace(REDUCED, **{side: replace(getattr(REDUCED, side), central_box=box[side]) for side in SIDES})
    for name, controls in zip(SIDES, segments(part), strict=True):
        side = getattr(part, name)
        for joint, cut, (ahead, behind) in zip(
            (side.front_joint, side.rear_joint), part.partition, pairwise(controls), strict=True
        ):
            for end in (ends_of(ahead)[1], ends_of(behind)[0]):
                assert end[0] == pytest.approx([cut, joint.height], abs=1e-15)
                assert slope_and_curvature(end) == pytest.approx((joint.angle, joint.curvature), abs=1e-10)


def test_the_leading_edge_has_the_direction_and_the_radius_asked_for():
    for sign, controls in zip((1.0, -1.0), segments(REDUCED), strict=True):
        angle, curvature = slope_and_curvature(ends_of(controls[0])[0])
        assert angle == pytest.approx(REDUCED.nose.angle + sign * 90.0, abs=1e-10)
        assert curvature == pytest.approx(-sign / REDUCED.nose.radius, rel=1e-10)


def test_the_reduced_form_has_22_parameters_and_the_full_one_52():
    def free(part):
        names = [path for path in part.parameters() if any(f".{segment}." in path for segment in SEGMENTS)]
        return len(names)

    assert free(REDUCED) == 22
    assert free(FULL) == 52


@pytest.mark.parametrize("name", list(AIRFOILS))
def test_sides_are_as_often_differentiable_by_s_as_their_joints_say(name):
    outline, near = AIRFOILS[name].outline(SPAN), 1e-9
    for joint in outline.joints:
        before, behind = (np.array(outline.derivatives(np.array([joint.s + step]), 3)) for step in (-near, near))
        # over 2e-9 a continuous derivative changes by that times the next one
        allowed = 1e-8 * (1.0 + np.max(np.abs(before)))
        kept = slice(joint.derivatives + 1)
        assert np.max(np.abs(before - behind)[..., kept]) < allowed


def test_continuity_is_that_of_what_is_given():
    joints = {joint.s: joint.derivatives for joint in MIXED.outline(SPAN).joints}
    # C1 above and C2 below at the front, C2 above and a corner below at the rear: the least counts
    assert (joints[CUTS[0]], joints[CUTS[1]]) == (1, 0)
    assert MIXED.outline(SPAN).leading_edge.kind == "sharp"
    assert [each.derivatives for each in FULL.outline(SPAN).joints if each.s in CUTS] == [0, 0]
    assert Joint(CUTS[0], 2) in REDUCED.outline(SPAN).joints


def test_an_open_trailing_edge_has_a_face_and_a_closed_one_has_none():
    assert "trailing_edge" in airfoil_of(REDUCED).build().curves
    assert "trailing_edge" not in airfoil_of(MIXED).build().curves


def test_cuts_move_the_joints():
    moved = REDUCED.changed({"partition[0]": 0.2, "partition[1]": 0.75})
    for side in segments(moved):
        assert [side[0][-1, 0], side[1][-1, 0]] == [0.2, 0.75]


@pytest.mark.parametrize("angles", ANGLES)
def test_a_morph_turns_both_edges_and_keeps_the_box_and_the_continuity(angles):
    part = replace(REDUCED, morph=Morph(leading_edge=angles[0], trailing_edge=angles[1]))
    before, after = segments(REDUCED), segments(part)
    for old, new in zip(before, after, strict=True):
        assert np.array_equal(old[1], new[1])
        for (ahead, behind), (first, second) in zip(pairwise(old), pairwise(new), strict=True):
            for one, other in ((ahead, first), (behind, second)):
                at = 1 if one is ahead else 0
                assert slope_and_curvature(ends_of(other)[at]) == pytest.approx(
                    slope_and_curvature(ends_of(one)[at]), abs=1e-9
                )
        assert np.array_equal(old[0][-3:], new[0][-3:])
        assert np.array_equal(old[2][:3], new[2][:3])
    for segment, (end, rows) in {0: (0, slice(None, -3)), 2: (-1, slice(3, None))}.items():
        middle = 0.5 * (before[0][1][end] + before[1][1][end])
        turn = np.radians(angles[segment // 2])
        rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
        for old, new in zip(before, after, strict=True):
            expected = middle + (old[segment][rows] - middle) @ rotation.T
            assert new[segment][rows] == pytest.approx(expected, abs=1e-14)


def test_a_positive_angle_droops_the_nose_and_a_negative_one_lowers_the_flap():
    morphed = airfoil_of(AIRFOILS["segmented-morphed"].changed("stagger_angle", 0.0)).build()
    straight = airfoil_of(REDUCED.changed("stagger_angle", 0.0)).build()
    ends = np.array([0.0, 1.0])
    lowered = straight.camber(ends)[:, 1] - morphed.camber(ends)[:, 1]
    assert lowered == pytest.approx(0.245 * np.sin(np.radians([4.0, 15.0])) * 0.3, rel=0.05)
    assert morphed.reference_chord == straight.chord
    assert morphed.chord < straight.chord


@pytest.mark.parametrize("angles", ANGLES)
def test_morphed_airfoils_build_smoothly(angles):
    section = airfoil_of(replace(REDUCED, morph=Morph(leading_edge=angles[0], trailing_edge=angles[1])))
    built = section.changed("tolerance", 1e-7).build()
    for name in SIDES:
        for cut in CUTS:
            sides = built.curvature(name, np.array([cut - 1e-7, cut + 1e-7]))
            assert sides[0] == pytest.approx(sides[1], rel=1e-2, abs=1e-2)


def test_a_morph_that_crosses_itself_is_refused_with_the_morph_as_cure():
    part = replace(REDUCED, morph=Morph(leading_edge=0.0, trailing_edge=-89.0))
    with pytest.raises(DesignError, match=r"crosses itself on its upper side.*smaller angles of morph"):
        airfoil_of(part).build()


def skinned(**fields):
    """The morphed airfoil with a morphed skin of the upper central box."""
    return SKINNED.changed({f"upper.central_box.skin.{name}": value for name, value in fields.items()})


def test_a_skin_keeps_what_its_joints_keep():
    for old, new in zip(*(segments(each)[0] for each in (replace(REDUCED, morph=SKINNED.morph), SKINNED)), strict=True):
        for one, other in zip(ends_of(old), ends_of(new), strict=True):
            assert other[0] == pytest.approx(one[0], abs=1e-15)
    before, after = segments(REDUCED)[0][1], segments(SKINNED)[0][1]
    assert np.max(np.abs(before - after)) > 1e-3
    for one, other in zip(ends_of(before), ends_of(after), strict=True):
        assert slope_and_curvature(other) == pytest.approx(slope_and_curvature(one), abs=1e-10)


def test_the_band_of_a_skin_is_as_wide_as_its_farthest_point_off_the_old_one():
    s = np.linspace(*CUTS, 4001)
    old, new = (
        airfoil_of(each).build().outline.points(s)[0][0] for each in (replace(SKINNED, upper=REDUCED.upper), SKINNED)
    )
    gaps = np.min(np.linalg.norm(new[::8, None] - old[None], axis=-1), axis=1)
    farthest = float(np.max(gaps))
    for outer, fits in ((farthest + 1e-6, True), (farthest - 1e-6, False)):
        design = airfoil_of(skinned(outer=outer))
        if fits:
            design.build()
            continue
        with pytest.raises(DesignError, match=r"upper.central_box.skin.outer is .* outside the old one"):
            design.build()
    with pytest.raises(DesignError, match=r"skin.inner is 0.001: .* inside the old one"):
        airfoil_of(skinned(ordinates=(-0.006,))).build()


def test_a_skin_without_changes_fits_a_band_of_no_width():
    bare = {"abscissas": (), "ordinates": (), "front_scale": None, "rear_scale": None}
    airfoil_of(skinned(inner=0.0, outer=0.0, **bare)).build()


def test_impossible_skins_are_refused():
    with pytest.raises(DesignError, match=r"skin.abscissas has 2 entries for 1 inner control points"):
        skinned(abscissas=(0.0, 0.0))
    with pytest.raises(DesignError, match=r"skin.rear_scale leaves a scale factor of -"):
        airfoil_of(skinned(rear_scale=-3.0)).build()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"partition": (0.7, 0.3)}, r"partition is 0.7, 0.3: the front cut must lie ahead"),
        ({"partition": (0.3,)}, r"partition has 1 entries: give 2"),
        ({"nose": None}, r"upper.leading_edge.front_scale is given, but no tangent"),
        ({"trailing_edge_thickness": -0.1}, r"trailing_edge_thickness is -0.1"),
    ],
)
def test_impossible_airfoils_are_refused(change, message):
    with pytest.raises(DesignError, match=message):
        airfoil_of(replace(REDUCED, **change)).build()


def test_impossible_parts_are_refused():
    with pytest.raises(DesignError, match="radius is given without angle"):
        Nose(radius=0.01)
    with pytest.raises(DesignError, match="curvature is given without angle"):
        SegmentJoint(height=0.1, curvature=1.0)
    with pytest.raises(DesignError, match="abscissas has 2 entries and ordinates 1"):
        Segment(abscissas=(0.1, 0.2), ordinates=(0.1,))
    with pytest.raises(DesignError, match="front_scale is 0: a scale factor"):
        Segment(abscissas=(0.1,), ordinates=(0.1,), front_scale=0.0)
    bare = Segment(abscissas=(0.85,), ordinates=(0.01,))
    with pytest.raises(DesignError, match=r"upper.trailing_edge.abscissas has 1 entries.*needs 2 or more"):
        replace(FULL, upper=replace(FULL.upper, trailing_edge=bare))
