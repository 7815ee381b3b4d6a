"""The report of a fit: figures to check by hand, JSON without holes, and a text that says the worst first."""

import copy
import json
import math
import pickle
from dataclasses import replace

import numpy as np
import pytest

from bladewright.fitting.assessment.measurement import Estimate
from bladewright.fitting.assessment.result import LISTED_OUTLIERS, Fit, Motion
from machines import example

DESIGN = example("turbine-section")
BUILT = DESIGN.build()
CHORD = float(BUILT.chord)
FIGURES = {"mean", "rms", "percentile_99", "maximum"}


def estimate(path, **changed):
    value = DESIGN.parameters()[path]
    given = {"deviation": 0.01, "low": value - 0.0196, "high": value + 0.0196, "identified": True, "at_bound": False}
    return Estimate(path=path, value=value, **(given | changed))


ESTIMATES = (
    estimate("stagger"),
    estimate("axial_chord", at_bound=True),
    estimate("thickness_upper[1]", deviation=math.inf, low=-math.inf, high=math.inf, identified=False),
)


def made(deviations, regions, inliers, **changed):
    """A fit of points that stand off the upper side by given distances."""
    count = len(deviations)
    u = np.linspace(0.0, 1.0, count)
    fit = Fit(
        design=DESIGN,
        built=BUILT,
        cloud=BUILT.curves["upper"](u),
        places=np.full(count, "upper"),
        u=u,
        v=np.zeros(count),
        deviations=np.array(deviations),
        regions=np.array(regions),
        inliers=np.array(inliers),
        set_aside=np.full(len(inliers), ""),
        estimates=ESTIMATES,
        covariance=np.diag([1e-4, 1e-4, math.inf]),
        rank=2,
        condition=math.inf,
        noise=2e-6,
        extrema={"upper": 3, "lower": 1},
        tolerance=None,
        failures=(),
        notes=(),
        evaluations=12,
    )
    return replace(fit, **changed)


PLAIN = made(
    [3e-6, -4e-6, 1e-3, 12e-6, -5e-6],
    ["leading edge", "sides", "sides", "sides", "trailing edge"],
    [True, True, False, True, True],
)


def test_deviations_are_those_of_the_inliers_in_metres_millimetres_and_chords():
    deviation = PLAIN.to_dict()["deviation"]
    assert deviation["all"]["m"]["mean"] == pytest.approx(6e-6)
    assert deviation["sides"]["m"]["maximum"] == pytest.approx(12e-6)
    assert deviation["sides"]["m"]["rms"] == pytest.approx(math.sqrt((16.0 + 144.0) / 2.0) * 1e-6)
    assert deviation["sides"]["count"] == 2
    for figures in (deviation[name] for name in ("all", "sides", "leading edge", "trailing edge")):
        for name in FIGURES:
            assert figures["mm"][name] == pytest.approx(1e3 * figures["m"][name])
            assert figures["of_chord"][name] == pytest.approx(figures["m"][name] / CHORD)


def test_a_region_without_points_has_no_figures_rather_than_perfect_ones():
    ends = PLAIN.to_dict()["deviation"]["ends"]
    assert ends["count"] == 0
    assert {value for unit in ("m", "mm", "of_chord") for value in ends[unit].values()} == {None}
    bare = made([1e-6], ["sides"], [True])
    assert "leading edge      none" in str(bare)


def test_outliers_are_listed_with_their_distances_and_the_worst_inlier_with_its_place():
    data = PLAIN.to_dict()
    assert data["outliers"]["count"] == 1
    assert data["outliers"]["listed"] == [
        {"index": 2, "distance_m": pytest.approx(1e-3), "distance_mm": pytest.approx(1.0)}
    ]
    assert data["outliers"]["farthest_m"] == pytest.approx(1e-3)
    assert (data["worst"]["index"], data["worst"]["region"], data["worst"]["u"]) == (3, "sides", 0.75)
    assert data["worst"]["deviation_mm"] == pytest.approx(0.012)


def test_only_the_first_thousand_outliers_are_listed_and_all_are_counted():
    count = LISTED_OUTLIERS + 7
    data = made(np.full(count, 1e-3), np.full(count, "sides"), np.zeros(count, dtype=bool)).to_dict()
    assert data["outliers"]["count"] == count
    assert [each["index"] for each in data["outliers"]["listed"]] == list(range(LISTED_OUTLIERS))
    assert data["worst"] is None


def test_the_report_is_json_without_anything_infinite():
    fit = replace(PLAIN, motion=Motion(rotation=np.eye(2), translation=np.zeros(2)), noise=math.nan)
    data = fit.to_dict()
    assert json.loads(json.dumps(data, allow_nan=False)) == data
    assert data["condition"] is None
    assert data["noise_m"] is None
    assert data["covariance"] == [[1e-4, 0.0, 0.0], [0.0, 1e-4, 0.0], [0.0, 0.0, None]]
    assert data["estimates"][2]["interval_95"] == [None, None]


def test_an_estimate_has_the_unit_of_its_field():
    units = {each["path"]: each["unit"] for each in PLAIN.to_dict()["estimates"]}
    assert units == {"stagger": "deg", "axial_chord": DESIGN.length_unit, "thickness_upper[1]": "-"}
    assert PLAIN.to_dict()["unidentified"] == ["thickness_upper[1]"]
    assert PLAIN.to_dict()["at_bounds"] == ["axial_chord"]


def test_the_text_says_first_whether_it_passed_and_why_not():
    lines = str(replace(PLAIN, failures=("the leading edge is off",), tolerance=1e-5, interrupted=True)).splitlines()
    assert lines[0] == f"{DESIGN.name}: FAILED, interrupted"
    assert lines[1] == "  - the leading edge is off"
    assert str(PLAIN).splitlines()[0] == f"{DESIGN.name}: passed"


def test_the_text_gives_millimetres_by_region_and_marks_doubtful_parameters():
    said = str(replace(PLAIN, tolerance=5e-5, notes=("no point lies on the hub",)))
    rows = {line[2:16].strip(): line[16:].split() for line in said.splitlines()}
    assert rows["all inliers"][:5] == ["4", "0.006", "0.00696", "0.0118", "0.012"]
    assert rows["leading edge"][:2] == ["1", "0.003"]
    assert "tolerance 0.05 mm, noise of the cloud 0.002 mm" in said
    assert "5 points, 1 outlier (20 %) up to 1 mm away: number 2" in said
    assert "extrema of curvature: 3 on the upper side, 1 on the lower side" in said
    assert "thickness_upper[1]" in next(line for line in said.splitlines() if line.endswith("NOT IDENTIFIED"))
    assert "axial_chord" in next(line for line in said.splitlines() if line.endswith("AT BOUND"))
    assert "+- 0.02" in next(line for line in said.splitlines() if "stagger" in line)
    assert said.splitlines()[-1] == "  note: no point lies on the hub"


def test_of_many_parameters_only_the_doubtful_ones_are_said():
    many = ESTIMATES + tuple(estimate("stagger") for _ in range(60))
    said = str(replace(PLAIN, estimates=many))
    assert "thickness_upper[1]" in said
    assert "stagger" not in said
    assert "the others (61) are identified and inside their bounds" in said


def test_a_motion_is_said_as_an_angle_and_a_shift():
    turn = np.array([[0.0, -1.0], [1.0, 0.0]])
    flat = replace(PLAIN, motion=Motion(rotation=turn, translation=np.array([0.001, 0.0])))
    assert "turned by 90 deg, then shifted by (1, 0) mm" in str(flat)
    turn = np.array([[1.0, 0.0, 0.0], [0.0, 0.8, -0.6], [0.0, 0.6, 0.8]])
    solid = replace(PLAIN, motion=Motion(rotation=turn, translation=np.zeros(3)))
    assert f"turned by {math.degrees(math.acos(0.8)):.6g} deg" in str(solid)
    assert solid.to_dict()["motion"]["rotation"] == turn.tolist()


def test_a_fit_survives_a_pickle_and_is_named_in_one_line():
    for other in (pickle.loads(pickle.dumps(PLAIN)), copy.deepcopy(PLAIN)):
        assert other.to_dict() == PLAIN.to_dict()
        np.testing.assert_array_equal(other.built.curves["upper"].control_points, BUILT.curves["upper"].control_points)
    line = repr(PLAIN)
    assert "\n" not in line
    assert all(word in line for word in (DESIGN.name, "UnifiedSection", "passed", f"{len(PLAIN.cloud)} points"))
