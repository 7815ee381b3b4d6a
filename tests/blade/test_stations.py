"""Blades of every family with laws given by values at stations."""

from dataclasses import replace

import numpy as np
import pytest

import bladewright as bw
from bladewright.derivatives.complex_step import varied
from bladewright.section.laws import Span, named_laws
from machines import built
from machines.stations import AXIAL, SPAN, TABLE, at_stations, moved

U, V = np.linspace(0.0, 1.0, 7)[:, None], np.array(TABLE.span)


def points(blade):
    return blade.surfaces["upper"](U, V)


def angle(forward, around):
    return np.degrees(np.arctan2(around, forward))


def cylindrical(points, vectors):
    """Components of vectors (n, 3) at points (n, 3): axial, and tangential towards larger theta."""
    theta = np.arctan2(points[..., 1], points[..., 2])
    return vectors[..., 0], np.cos(theta) * vectors[..., 1] - np.sin(theta) * vectors[..., 2]


@pytest.mark.parametrize("family", ["unified", "curvature-meanline", "suction-pressure", "camber-angle"])
def test_the_metal_angle_on_the_surface_is_the_tables_at_every_station(family):
    side = built(AXIAL[family]).surfaces["upper"]
    along, around = cylindrical(side(1.0, V), side.derivative(1.0, V, du=1))
    # where a round edge ends, a side runs across the camber line; the wedges of an elliptic edge turn it by 1e-3 deg
    close = 2e-3 if family == "suction-pressure" else 1e-9
    assert angle(-around, along) == pytest.approx(TABLE.values, abs=close)
    assert angle(-around, along)[1] == pytest.approx(-22.0, abs=close)


@pytest.mark.parametrize("family", ["profile", "wedge-diffuser"])
def test_the_stagger_on_the_surface_is_the_tables_at_every_station(family):
    side = built(AXIAL[family]).surfaces["upper"]
    ends = side(0.0, V), side(1.0, V)
    theta = [np.arctan2(points[:, 1], points[:, 2]) for points in ends]
    radius = np.hypot(ends[0][:, 1], ends[0][:, 2])
    assert angle(ends[1][:, 0] - ends[0][:, 0], radius * (theta[1] - theta[0])) == pytest.approx(TABLE.values, abs=1e-9)


@pytest.mark.parametrize("family", AXIAL)
def test_a_file_keeps_stations_to_the_bit(family, tmp_path):
    design, path = AXIAL[family], tmp_path / "design.toml"
    bw.write_design(design, path)
    assert bw.read_design(path) == design
    assert "{ span = [0.0, 0.25, 0.5, 0.75, 1.0], values = [-8.0, -22.0, -34.0, -42.0, -48.0] }" in path.read_text()


@pytest.mark.parametrize("family", AXIAL)
def test_every_law_of_a_family_may_be_given_at_stations(family):
    design = at_stations(AXIAL[family], "monotone")
    values, given = dict(named_laws(design)), dict(named_laws(AXIAL[family]))
    for path, law in values.items():
        assert Span(np.array(SPAN)).values(law) == pytest.approx(Span(np.array(SPAN)).values(given[path]), abs=1e-12)
    exact, before = design.exact_blade(), AXIAL[family].exact_blade()
    exact.check()
    assert exact.breaks_along_v() == pytest.approx(np.repeat(SPAN[1:-1], 3))
    # at the stations the sections are those of the laws that were sampled there
    found, known = (each.sections(np.array(SPAN)).points(np.array([0.3, 0.7]))[0] for each in (exact, before))
    assert found == pytest.approx(known, abs=1e-10)


@pytest.mark.parametrize("family", AXIAL)
def test_derivatives_by_values_are_those_of_differences(family):
    design, blade = AXIAL[family], built(AXIAL[family])
    path = next(path for path, law in named_laws(design) if law == TABLE)
    found = bw.sensitivity(design, points, free=f"{path}.values*", knots=blade.knots)
    assert list(found) == [f"{path}.values[{i}]" for i in range(5)]
    step = 1e-3
    moves = [{f"{path}.values[1]": -22.0 + each * step} for each in (1.0, -1.0)]
    one, other = (points(each) for each in varied(design, blade, moves))
    assert found[f"{path}.values[1]"] == pytest.approx((one - other) / (2.0 * step), abs=1e-7 * blade.chord)


@pytest.mark.parametrize("way", ["monotone", "linear"])
def test_derivatives_and_pullbacks_hold_for_each_interpolation(way):
    design = AXIAL["unified"].changed("metal_angle_out", replace(TABLE, interpolation=way))
    design = design.changed("thickness_upper[1]", moved(TABLE, lambda _: 0.03))
    blade = design.build()
    paths, step = ["metal_angle_out.values[2]", "thickness_upper[1].values[3]"], 1e-4
    found = bw.sensitivity(design, points, free=paths, knots=blade.knots)
    bar = np.cos(np.arange(U.size * V.size * 3.0)).reshape(U.size, V.size, 3)
    pulled = bw.pullback(design, {"upper": (U, V, bar)}, free=paths, knots=blade.knots)
    for path in paths:
        value = design.parameters()[path]
        one, other = (points(design.changed(path, value + each).build(knots=blade.knots)) for each in (step, -step))
        assert found[path] == pytest.approx((one - other) / (2.0 * step), abs=1e-6 * np.max(np.abs(found[path])))
        assert pulled[path] == pytest.approx(np.sum(bar * found[path]), rel=1e-9)


def test_a_file_keeps_its_comments_and_a_table_of_its_own_for_a_law(tmp_path):
    path = tmp_path / "design.toml"
    bw.write_design(AXIAL["profile"], path)
    line = next(line for line in path.read_text().splitlines() if line.startswith("stagger_angle"))
    table = "[section.stagger_angle] # from the meridional analysis\nspan = [0, 0.25, 0.5, 0.75, 1]\n"
    text = path.read_text().replace(line, "")
    path.write_text(f"{text}\n{table}values = [-8, -22, -34, -42, -48] # deg\n")
    assert bw.read_design(path) == AXIAL["profile"]
    changed = AXIAL["profile"].changed("section.stagger_angle.values[2]", -33.0)
    bw.write_design(changed, path)
    assert "# from the meridional analysis\nspan = [0, 0.25, 0.5, 0.75, 1]\n" in path.read_text()
    assert "values = [-8, -22, -33.0, -42, -48] # deg" in path.read_text()
    assert bw.read_design(path) == changed
    other = changed.changed("section.stagger_angle", moved(replace(TABLE, interpolation="linear"), lambda out: -out))
    bw.write_design(other, path)
    assert bw.read_design(path) == other
    bw.write_design(changed.changed("section.stagger_angle", (1.0, 2.0)), path)
    assert bw.read_design(path).section.stagger_angle == (1.0, 2.0)


@pytest.mark.parametrize("family", ["unified", "curvature-meanline"])
def test_a_design_with_stations_builds_the_same_with_its_knots_held(family):
    blade = built(AXIAL[family])
    again = AXIAL[family].build(knots=blade.knots)
    for one, other in zip(blade.sides, again.sides, strict=True):
        assert np.array_equal(one.control_points, other.control_points)


def test_values_at_stations_are_variables():
    blade = built(AXIAL["unified"])
    space = bw.variables(AXIAL["unified"], free="metal_angle_out.values*", knots=blade.knots)
    assert space.vector(AXIAL["unified"]) * space.scale == pytest.approx(TABLE.values)
    assert set(space.scale) == {10.0}


FILE_ERRORS = {
    "{ span = [0, 1] }": "metal_angle_out.values is missing: a list of numbers [deg] must be given",
    "{ span = [0, 1], values = [1, 'x'] }": 'metal_angle_out.values[1] is "x": a number [deg] is needed',
    "{ span = [0, 1], vals = [1, 2] }": "metal_angle_out.vals does not exist; did you mean 'values'?",
    "{ span = [0, 1], values = [1, 2], interpolation = 'natrual' }": "did you mean 'natural'?",
    "{ span = [0, 0.5], values = [1, 2] }": "metal_angle_out.span runs from 0 to 0.5",
    "'abc'": 'metal_angle_out is "abc": a number or a list of numbers or a table of span, values, interpolation',
}


@pytest.mark.parametrize("law", FILE_ERRORS)
def test_a_file_with_a_wrong_law_is_told_the_mistake(law, tmp_path):
    path = tmp_path / "design.toml"
    bw.write_design(AXIAL["unified"].changed("metal_angle_out", -30.0), path)
    path.write_text(path.read_text().replace("metal_angle_out = -30.0", f"metal_angle_out = {law}"))
    with pytest.raises(bw.DesignError) as caught:
        bw.read_design(path)
    assert FILE_ERRORS[law] in str(caught.value)
    assert "\n" not in str(caught.value)
