"""The station table: closed forms, relations between its columns, exact sections, and exact derivatives."""

import csv
import io
import json
from dataclasses import replace

import numpy as np
import pytest

import bladewright as bw
from bladewright.blade.design.flow_path import FlowPath
from bladewright.derivatives.complex_step import varied
from bladewright.errors import DesignError
from bladewright.section.profiles.circular_arc import DoubleCircularArc
from machines import COARSE, built, stacked
from machines.coarse import CASCADE, CLEARED, RADIAL, ROTOR, SECTION
from machines.sectioned import BLUNT, COMPRESSOR, DIFFUSER, IMPELLER, PLATE, through

FLAT = FlowPath(hub=through((-60, 0), (120, 0)), shroud=through((-60, 50), (120, 50)))
UPRIGHT = {
    "flow_path": FLAT,
    "leading_edge": through((0, -10), (0, 60)),
    "trailing_edge": through((40, -10), (40, 60)),
}
BLADES = {
    each.name: each.changed("tolerance", COARSE)
    for each in (ROTOR, CLEARED, RADIAL, CASCADE, COMPRESSOR, BLUNT, IMPELLER, DIFFUSER, stacked.RULED, stacked.MILLED)
}


@pytest.fixture(scope="module", params=list(BLADES))
def blade(request):
    return built(BLADES[request.param])


def test_every_quantity_of_every_family_is_finite_and_their_relations_hold(blade):
    table = blade.report([0.0, 0.3, 1.0])
    for name in table.names:
        assert np.isfinite(table[name]).all(), name
    assert table.solidity * table.pitch_to_chord == pytest.approx(np.ones(3), rel=1e-14)
    assert table.chord * np.cos(table.stagger) == pytest.approx(table.meridional_chord, rel=1e-14)
    assert table.turning == pytest.approx(table.metal_angle_in - table.metal_angle_out, abs=1e-15)
    assert (table.throat > 0.0).all()
    assert (table.maximum_thickness_at > 0.0).all()
    # of a blade that is thickest at a blunt edge, the middle of its face lies within its thickness of the chord line
    assert (table.maximum_thickness_at < 1.0 + 1e-3).all()
    assert table.trailing_edge_x - table.leading_edge_x == pytest.approx(table.axial_chord, abs=1e-15)


def test_what_sections_have_too_is_the_same(blade):
    spans = [v for v in (0.0, 0.3, 1.0) if blade.exact.survey.skinning == "sections"]
    if not spans:
        pytest.skip("a ruled or developable blade has no sections between its ends")
    table = blade.report(spans)
    sections = blade.sections_at(spans)
    limit = 2.0 * COARSE
    assert table.chord == pytest.approx([each.chord for each in sections], rel=limit)
    assert table.stagger == pytest.approx([each.stagger for each in sections], abs=limit)
    assert table.metal_angle_in == pytest.approx([each.metal_angle_in for each in sections], abs=1e-6)
    assert table.metal_angle_out == pytest.approx([each.metal_angle_out for each in sections], abs=1e-6)
    # of unequal sides the connection of the thickest points is not normal to the camber line
    assert table.maximum_thickness == pytest.approx([each.maximum_thickness[0] for each in sections], rel=5e-3)


def test_a_plate_has_its_stagger_chord_and_thickness():
    plate = replace(PLATE, **UPRIGHT, section=replace(PLATE.section, stagger_angle=25.0), leading_edge_y=(0.0, 6.0))
    table = plate.build().report()
    assert np.degrees(table.stagger) == pytest.approx(np.full(5, 25.0), abs=1e-9)
    chord = 0.04 / np.cos(np.radians(25.0))
    assert table.chord == pytest.approx(np.full(5, chord), rel=1e-12)
    assert table.maximum_thickness == pytest.approx(np.full(5, 0.08 * chord), rel=1e-9)
    assert table.leading_edge_thickness == pytest.approx(np.full(5, 0.08 * chord), rel=1e-9)
    assert table.wrap == pytest.approx(np.full(5, 0.04 * np.tan(np.radians(25.0))), rel=1e-9)
    assert table.solidity == pytest.approx(np.full(5, chord / 0.04), rel=1e-12)
    # neighbouring plates run side by side: what the pitch leaves across them less their thickness
    assert table.throat == pytest.approx(np.full(5, 0.04 * np.cos(np.radians(25.0)) - 0.08 * chord), rel=1e-6)
    # a linear lean of 6 mm over 50 mm leans every line of the blade, and sweeps none
    for name in ("lean", "trailing_edge_lean"):
        assert np.tan(table[name]) == pytest.approx(np.full(5, 6.0 / 50.0), rel=1e-6)
    assert table.leading_edge_sweep == pytest.approx(np.zeros(5), abs=1e-9)
    assert table.inlet_area == pytest.approx(0.04 * 0.05, rel=1e-9)
    assert "leading_edge_radius" not in table.names


def test_a_plate_of_steel_has_the_mass_and_inertia_of_a_box():
    plate = replace(PLATE, **UPRIGHT, section=replace(PLATE.section, stagger_angle=0.0), density=7800.0)
    blade = plate.build()
    size = np.array([0.04, 0.08 * 0.04, 0.05])
    mass, report = 7800.0 * np.prod(size), blade.mass_report()
    inertia = mass / 12.0 * (np.sum(size**2) - size**2)
    assert blade.mass == pytest.approx(mass, rel=1e-9)
    assert report.centre == pytest.approx([0.02, 0.0, 0.025], abs=1e-9)
    assert report.inertia == pytest.approx(np.diag(inertia), rel=1e-8, abs=1e-15)
    # by Steiner's theorem about the x axis
    assert report.inertia_about_axis[0, 0] == pytest.approx(inertia[0] + mass * 0.025**2, rel=1e-9)
    assert blade.report().to_dict()["mass"] == pytest.approx(mass, rel=1e-9)
    assert "mass" in str(blade.report())


def test_an_arc_turns_by_its_camber_angle():
    arc = DoubleCircularArc(
        camber_angle=40.0, thickness=0.06, leading_edge_radius=0.005, trailing_edge_radius=0.005, stagger_angle=-30.0
    )
    table = replace(PLATE, **UPRIGHT, section=arc).build().report([0.5])
    assert np.degrees(table.turning) == pytest.approx([40.0], abs=1e-6)
    assert np.degrees(table.metal_angle_in) == pytest.approx([-10.0], abs=1e-6)
    assert np.degrees(table.stagger) == pytest.approx([-30.0], abs=1e-9)
    assert table.thickness_to_chord == pytest.approx([0.06], rel=1e-6)
    assert table.maximum_thickness_at == pytest.approx([0.5], abs=1e-6)
    assert table.leading_edge_radius == pytest.approx(0.005 * table.chord, rel=1e-6)


def test_the_pitch_of_an_annulus_is_its_circumference_over_the_blades():
    table = built(BLADES[COMPRESSOR.name]).report()
    for name, radius in (("pitch_in", table.leading_edge_r), ("pitch_out", table.trailing_edge_r)):
        assert table[name] == pytest.approx(2.0 * np.pi * radius / COMPRESSOR.blade_count, rel=1e-14)


def test_areas_are_those_of_the_annulus():
    # LE and TE of the diffuser are cylinders: what radial flow sees of them
    table = built(BLADES[DIFFUSER.name]).report()
    assert table.inlet_area == pytest.approx(2.0 * np.pi * 0.15 * 0.025 / 12, rel=1e-6)
    assert table.outlet_area == pytest.approx(2.0 * np.pi * 0.25 * 0.025 / 12, rel=1e-6)
    assert np.degrees(table.leading_edge_sweep) == pytest.approx(np.zeros(5), abs=1e-6)


def test_the_throat_is_that_of_the_row(blade):
    own = bw.throat(blade)
    middle = len(own.v) // 2
    assert blade.report([own.v[middle]]).throat == pytest.approx([own.width[middle]], rel=1e-12)


DIFFERENTIATED = ("turning", "stagger", "chord", "solidity", "wrap", "throat", "maximum_thickness", "blockage")
DIFFERENTIATED += ("maximum_thickness_at", "lean", "leading_edge_sweep", "gauge_angle", "leading_edge_radius")
DIFFERENTIATED += ("pitch_mid", "metal_angle_out", "trailing_edge_lean")


def quantities(blade):
    table = blade.report([0.4])
    return np.concatenate([*(table[name] for name in DIFFERENTIATED), [table.inlet_area, table.throat_area]])


@pytest.mark.parametrize(
    ("design", "path", "step"),
    [
        (CLEARED, "channel.hub[0].r", 0.02),
        (CASCADE, "stagger[0]", 0.02),
        pytest.param(CASCADE, "pitch", 0.02, marks=pytest.mark.slow),
        (BLADES[COMPRESSOR.name], "section.metal_angle_out[1]", 0.02),
        pytest.param(BLADES[COMPRESSOR.name], "section.thickness.maximum_thickness[1]", 1e-4, marks=pytest.mark.slow),
        (BLADES[BLUNT.name], "leading_edge.points[1].x", 0.02),
        pytest.param(BLADES[stacked.RULED.name], "section.camber_angle[1][0]", 0.02, marks=pytest.mark.slow),
        pytest.param(BLADES[stacked.MILLED.name], "section.stagger_angle", 0.02, marks=pytest.mark.slow),
    ],
    ids=["wall", "stagger", "pitch", "metal angle", "thickness", "edge", "ruled", "developable"],
)
def test_every_quantity_has_the_derivative_that_differences_approach(design, path, step):
    base = built(design)
    found = bw.sensitivity(design, quantities, free=[path], knots=base.knots)[path]
    value = design.parameters()[path]
    moved = [quantities(each) for each in varied(design, base, [{path: value + k * step} for k in (1, -1, 2, -2)])]
    expected = (8.0 * (moved[0] - moved[1]) - (moved[2] - moved[3])) / (12.0 * step)
    size = np.abs(quantities(base)) / value
    assert np.abs(expected).max() > 0.0
    for name, own, other, unit in zip([*DIFFERENTIATED, "inlet", "throat area"], found, expected, size, strict=True):
        assert own == pytest.approx(other, abs=1e-6 * max(abs(other), abs(unit), 1e-5)), name


def test_a_section_has_a_report_with_exact_derivatives():
    table = SECTION.build().report()
    assert table.names[1] == "leading_edge_x"
    assert table.chord == pytest.approx(0.04 / np.cos(np.radians([30.0])), rel=1e-14)
    assert np.degrees(table.turning) == pytest.approx([70.0], abs=1e-12)
    prism = bw.prismatic(SECTION, span=50.0).build().report([0.5])
    for name in table.names[1:]:
        assert table[name] == pytest.approx(prism[name], rel=1e-5, abs=1e-12), name
    found = bw.sensitivity(SECTION, lambda section: section.report().throat, free=["pitch", "stagger"])
    for path, step in (("pitch", 1e-3), ("stagger", 1e-3)):
        ends = [SECTION.changed(path, SECTION.parameters()[path] + d).build().report().throat for d in (step, -step)]
        assert found[path] == pytest.approx((ends[0] - ends[1]) / (2.0 * step), rel=1e-6)


def test_a_section_without_a_pitch_has_no_pitch_columns():
    table = SECTION.changed("pitch", None).build().report()
    assert not {"pitch_mid", "solidity", "throat", "blockage"} & set(table.names)
    with pytest.raises(DesignError, match="pitch is missing"):
        _ = table.solidity


def test_dictionary_and_csv_hold_the_columns_in_the_design_s_units():
    table = built(ROTOR).report([0.0, 0.5])
    data = table.to_dict()
    json.dumps(data)
    assert data["units"]["chord"] == "mm"
    assert data["stations"]["chord"] == pytest.approx(1e3 * table.chord, rel=1e-15)
    rows = list(csv.DictReader(io.StringIO(table.to_csv())))
    assert [float(row["metal_angle_in [deg]"]) for row in rows] == list(np.degrees(table.metal_angle_in))
    assert [float(row["span"]) for row in rows] == [0.0, 0.5]
    assert repr(table) == f"<BladeStations of rotor: {len(table.names)} quantities at 2 stations>"


@pytest.mark.parametrize("stations", [[1.2], [-0.1, 0.5], [], [float("nan")], "half"])
def test_stations_outside_the_blade_are_refused(stations):
    with pytest.raises(DesignError, match="span fractions"):
        built(ROTOR).report(stations)


def test_a_section_of_a_blade_sends_to_the_blade():
    with pytest.raises(DesignError, match=r"ask the blade, blade.report\(\[0.4\]\)"):
        built(ROTOR).section(0.4).report()


def test_the_table_of_a_strange_column_names_the_nearest():
    with pytest.raises(DesignError, match="did you mean 'solidity'"):
        _ = built(ROTOR).report()["solidty"]
