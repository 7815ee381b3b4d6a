"""Designs from tables of stations: what is met, what is assumed, what is refused."""

import numpy as np
import pytest

import bladewright as bw
from bladewright.designs import Stations
from bladewright.errors import DesignError, FileError
from bladewright.files.from_table import design_from_table
from bladewright.files.given_table import given_table
from bladewright.files.table_formulas import stagger_of

HEADER = (
    "r [mm],metal_angle_in [deg],metal_angle_out [deg],chord [mm],maximum_thickness [mm],maximum_thickness_at [%],"
    "leading_edge_radius [mm],trailing_edge_radius [mm]"
)
ROWS = np.array(
    [
        [100.0, 44.0, -8.0, 50.0, 5.0, 45.0, 0.5, 0.4],
        [115.0, 49.0, 22.0, 50.0, 4.5, 47.0, 0.45, 0.35],
        [130.0, 53.0, 34.0, 51.0, 4.0, 50.0, 0.4, 0.3],
        [145.0, 57.0, 42.0, 52.0, 3.6, 52.0, 0.35, 0.3],
        [160.0, 60.0, 48.0, 52.0, 3.2, 55.0, 0.3, 0.25],
    ]
)


def csv(rows=ROWS, header=HEADER, sign=","):
    return "\n".join([header.replace(",", sign), *(sign.join(f"{each:.12g}" for each in row) for row in rows)]) + "\n"


@pytest.fixture
def made(tmp_path):
    def make(text, **changes):
        (tmp_path / "rotor.csv").write_text(text)
        found = design_from_table(tmp_path / "rotor.csv", changes)
        (tmp_path / "rotor.toml").write_text(found.text)
        assert bw.read_design(tmp_path / "rotor.toml") == found.design
        return found

    return make


def measured(blade, v):
    """What a table says, measured on a built blade's section: angles [deg], lengths [mm]."""
    section = blade.section(v)
    return [
        np.degrees(section.metal_angle_in),
        np.degrees(section.metal_angle_out),
        1e3 * section.chord,
        1e3 * section.maximum_thickness[0],
        *(1e3 * float(each) for each in section.edge_radii),
    ]


def test_a_table_is_met_at_every_station(made):
    found = made(csv())
    blade = found.design.build()
    for row in ROWS:
        v = (row[0] - 100.0) / 60.0
        assert measured(blade, v) == pytest.approx(row[[1, 2, 3, 4, 6, 7]].tolist(), rel=2e-6)
    assert found.design.blade_count == round(1.2 * 2.0 * np.pi * 130.0 / 51.0)
    assert "# assumed: a solidity of about 1.2" in found.text
    assert "# assumed: a straight annulus" in found.text


def test_a_stagger_bends_the_meanline(made):
    stagger = np.array([19.0, 36.0, 43.0, 49.0, 53.8])
    found = made(csv(np.column_stack([ROWS, stagger]), f"{HEADER},stagger [deg]"))
    exact = found.design.exact_blade()
    for row, wanted in zip(ROWS, stagger, strict=True):
        section = exact.section((row[0] - 100.0) / 60.0)
        assert np.degrees(section.stagger) == pytest.approx(wanted, abs=1e-9)
        assert np.degrees(section.metal_angle_out) == pytest.approx(row[2], abs=1e-7)


VANE_HEADER = (
    "r [in],stagger [deg],metal_angle_in [deg],metal_angle_out [deg],axial chord [in],max thickness [%],LE radius [in]"
)
VANE_ROWS = [[10, -38, 5, -62, 1.5, 14, 0.06], [11, -37, 0, -62, 1.5, 13, 0.06], [12, -46, -5, -62, 1.5, 12, 0.05]]


def test_a_turbine_vane_in_inches_has_its_stagger_far_from_the_mean_of_its_angles(made):
    found = made(csv(VANE_ROWS, VANE_HEADER))
    assert found.design.length_unit == "in"
    exact = found.design.exact_blade()
    for v, stagger, most, radius in ((0.0, -38.0, 0.14, 0.06), (0.5, -37.0, 0.13, 0.06), (1.0, -46.0, 0.12, 0.05)):
        section = exact.section(v)
        assert np.degrees(section.stagger) == pytest.approx(stagger, abs=1e-7)
        assert section.chord / 0.0254 == pytest.approx(1.5 / np.cos(np.radians(stagger)), rel=1e-12)
        assert section.maximum_thickness[0] / section.chord == pytest.approx(most, rel=1e-5)
        assert section.edge_radii[0] / 0.0254 == pytest.approx(radius, rel=1e-7)


def test_an_impeller_s_hub_keeps_off_the_axis(made):
    header = "span,x_le [mm],r_le [mm],x_te [mm],r_te [mm],metal_angle_in [deg],metal_angle_out [deg]"
    found = made(f"{header}\n0,0,16,38,70,-42,-35\n0.5,0,29,35,70,-50,-35\n1,0,42,32,70,-57,-35\n")
    assert min(point.r for point in found.design.flow_path.hub.points) >= 8.0
    assert "# in the plane (m', theta): where the radius changes" in found.text


def test_other_units_names_and_signs_give_the_same_blade(made):
    factors = [1e-3, np.pi / 180.0, np.pi / 180.0, 1.0 / 25.4, 1.0 / 25.4, 0.01, 1.0 / 25.4, 1.0 / 25.4]
    header = (
        "Radius (m),Inlet metal angle (rad),Outlet metal angle (rad),chord [in],max thickness [in],"
        "maximum_thickness_at,LE radius [in],TE radius [in]"
    )
    other, known = made("# a remark\n\n" + csv(ROWS * factors, header, ";")).design, made(csv()).design
    assert other.length_unit == "m"
    assert other.exact_blade().sections(np.array([0.0, 0.4, 1.0])).points(np.linspace(0.0, 1.0, 5))[0] == pytest.approx(
        known.exact_blade().sections(np.array([0.0, 0.4, 1.0])).points(np.linspace(0.0, 1.0, 5))[0], abs=1e-9
    )


def test_radii_become_span_fractions_where_each_quantity_stands(made):
    header = "r_le [mm],r_te [mm],metal_angle_in [deg],metal_angle_out [deg],chord [mm],theta [deg]"
    rows = np.array([[50, 60, 50, 20, 40, 0], [70, 75, 55, 30, 42, 1], [100, 95, 60, 40, 45, 3]])
    design = made(csv(rows, header)).design
    assert design.section.metal_angle_in.span == pytest.approx((0.0, 0.4, 1.0), abs=1e-13)
    assert design.section.metal_angle_out.span == pytest.approx((0.0, 15.0 / 35.0, 1.0), abs=1e-13)
    assert design.stacking.chord.span == pytest.approx((0.0, 17.5 / 42.5, 1.0), abs=1e-13)
    assert design.stacking.theta.values == (0.0, 1.0, 3.0)


def test_edges_in_x_and_r_say_where_the_blade_stands(made):
    header = "span [%],x_le [mm],r_le [mm],x_te [mm],r_te [mm],metal_angle_in [deg],metal_angle_out [deg]"
    rows = np.array([[0, 0, 50, 40, 55, 50, 20], [50, 1, 75, 38, 77, 55, 30], [100, 4, 100, 36, 99, 60, 40]])
    design = made(csv(rows, header)).design
    view = design.exact_blade().sections(np.array([0.0, 0.5, 1.0])).lines.position(np.array([0.0, 1.0]))
    for end, columns in ((0, rows[:, 1:3]), (1, rows[:, 3:5])):
        assert 1e3 * view[[0, 2], end] == pytest.approx(columns[[0, 2]], abs=1e-6)
        # the middle row's stream surface rises towards the point that its quasi-orthogonal divides in half
        assert 1e3 * view[1, end] == pytest.approx(columns[1], abs=0.1)
    assert design.leading_edge.points[1] == (1.0, 75.0)
    assert design.section.metal_angle_in == Stations(span=(0.0, 0.5, 1.0), values=(50.0, 55.0, 60.0))


def test_the_station_table_of_what_is_built_makes_the_blade_again(made):
    first = made(csv(), blade_count=19).design.build()
    spans = [(row[0] - 100.0) / 60.0 for row in ROWS]
    found = made(first.report(stations=spans).to_csv())
    assert "# results in the table are left out: turning, " in found.text
    again = found.design.build()
    assert found.design.blade_count == 19
    for v in spans:
        assert measured(again, v) == pytest.approx(measured(first, v), rel=1e-4)


def test_what_is_set_is_no_assumption(made):
    found = made(csv(), blade_count=23)
    assert found.design.blade_count == 23
    assert "solidity" not in found.text


def test_a_table_of_an_impossible_blade_is_refused(made):
    with pytest.raises(DesignError, match=r"rotor\.csv' makes a blade that cannot be built: .*neighbouring"):
        made(csv(), blade_count=200)


SMALL = "r [mm],metal_angle_in [deg],metal_angle_out [deg],chord [mm]\n"
REFUSED = {
    "is empty: its first line names the columns": "# nothing\n",
    "has 1 rows of numbers: two stations at least": f"{SMALL}1,2,3,4\n",
    "line 3 has 3 entries, and the header 4": f"{SMALL}1,2,3,4\n2,3,4\n",
    "line 3: chord is 'forty': a number": f"{SMALL}1,2,3,4\n2,2,3,forty\n",
    "line 3: chord is empty": f"{SMALL}1,2,3,4\n2,2,3,\n",
    "r is 1 in row 2 after 2: it must rise from hub to shroud": f"{SMALL}2,2,3,4\n1,2,3,4\n",
    "the column chord is in [furlong], which is not understood: give it in [mm]": SMALL.replace(
        "chord [mm]", "chord [furlong]"
    )
    + "1,2,3,4\n2,2,3,4\n",
    "the column metal_angle_in has no unit": SMALL.replace("in [deg]", "in") + "1,2,3,4\n2,2,3,4\n",
    "the column metal_angle_inn does not exist; did you mean 'metal_angle_in'?": SMALL.replace("angle_in", "angle_inn")
    + "1,2,3,4\n2,2,3,4\n",
    "has no column metal_angle_out": "r [mm],metal_angle_in [deg],chord [mm]\n1,2,3\n2,2,3\n",
    "does not say where its rows stand": "metal_angle_in [deg],metal_angle_out [deg],chord [mm]\n1,2,3\n2,2,3\n",
    "has no radii": "span,metal_angle_in [deg],metal_angle_out [deg],chord [mm]\n0,1,2,3\n1,2,2,3\n",
    "span runs from 0.05 to 0.95": "span,r [mm],metal_angle_in [deg],metal_angle_out [deg]\n0.05,1,2,3\n0.95,2,2,3\n",
    "says how long the sections are by nothing": "r [mm],metal_angle_in [deg],metal_angle_out [deg]\n1,2,3\n2,2,3\n",
    "has two columns r": f"radius [mm],{SMALL}1,1,2,3,4\n2,2,2,3,4\n",
    "stagger is 60 deg in row 1, between metal angles of 50 and 20 deg": SMALL.replace("chord", "stagger [deg],chord")
    + "50,50,20,60,40\n90,50,20,35,40\n",
}


@pytest.mark.parametrize("message", REFUSED)
def test_a_bad_table_is_refused_in_a_paragraph(message, made):
    with pytest.raises(FileError) as caught:
        made(REFUSED[message])
    assert message in str(caught.value)
    assert "rotor.csv" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_equal_values_are_one_number_and_two_stations_are_enough(made):
    design = made(f"{SMALL}50,50,20,40\n90,50,25,40\n").design
    assert design.section.metal_angle_in == 50.0
    assert design.section.metal_angle_out == Stations(span=(0.0, 1.0), values=(20.0, 25.0))
    assert given_table(f"{SMALL}50,50,20,40\n90,50,25,40\n", "x").length_unit == "mm"


def test_the_station_table_of_a_radial_machine_is_one_to_start_from(made):
    header = "span,r_le [mm],r_te [mm],x_le [mm],x_te [mm],metal_angle_in [deg],metal_angle_out [deg],chord [mm],"
    header += "meridional_chord [mm]"
    # lengths along a curved stream line, as an impeller has them, are longer than the way between its edges
    hub, tip = (20.0, 60.0, 0.0, 30.0, -30.0, -35.0, 70.0, 60.0), (35.0, 60.0, 5.0, 22.0, -50.0, -40.0, 50.0, 36.0)
    found = made(csv([(0.0, *hub), (1.0, *tip)], header))
    assert "x and r of the edges say how long" in found.remarks["leading_edge"]
    table = found.design.build().report([0.0, 1.0])
    assert table.values("leading_edge_r") == pytest.approx([20.0, 35.0], rel=1e-6)
    assert table.values("metal_angle_out") == pytest.approx([-35.0, -40.0], abs=1e-4)


@pytest.mark.parametrize("share", [0.2, 0.5, 0.75])
def test_the_stagger_of_a_strong_turning_lies_within_a_right_angle_of_both_ends(share):
    inlet, outlet = 30.0, -62.0
    stagger = stagger_of(inlet, outlet, share)
    assert inlet - 90.0 < stagger < outlet + 90.0
    first, last = np.tan(np.radians([inlet - stagger, outlet - stagger]))
    assert first / (first - last) == pytest.approx(share, rel=1e-9)
