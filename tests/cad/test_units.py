"""Units of CAD files: written in millimetres, metres or inches, and the same solid when they are read."""

import re

import numpy as np
import pytest

from bladewright import cad
from bladewright.cad.mesh_files import read_3mf, read_stl
from bladewright.cad.reading import read_cad_file
from bladewright.cad.units import MILLIMETRES
from bladewright.errors import CadError

from .conftest import COARSE

ENDINGS = ("step", "igs", "stl", "3mf")


def step_corners(path):
    """The vertices of a STEP file in the file's own numbers."""
    text = path.read_text().replace("\n", "")
    points = dict(re.findall(r"#(\d+) = CARTESIAN_POINT\('',\(([^)]*)\)\s*\)", text))
    ends = re.findall(r"VERTEX_POINT\('',#(\d+)\)", text)
    return np.array([[float(x) for x in points[number].split(",")] for number in ends])


@pytest.fixture(scope="module")
def vane(bodies):
    return bodies["linear"]


@pytest.fixture(scope="module")
def written(vane, filed, tmp_path_factory):
    """Files of a blade in every unit and format with their round trips, by unit and ending."""
    folder = tmp_path_factory.mktemp("units")
    made = {("mm", ending): filed("linear", ending) for ending in ENDINGS}
    for unit in ("m", "in"):
        for ending in ENDINGS:
            path = folder / f"{unit}.{ending}"
            made[unit, ending] = path, cad.write(vane, path, unit=unit, samples=200, chordal_deviation=COARSE)
    return made


@pytest.mark.parametrize("ending", ENDINGS)
@pytest.mark.parametrize("unit", MILLIMETRES)
def test_a_file_in_any_unit_is_the_same_solid(written, unit, ending):
    trip = written[unit, ending][1]
    assert trip.passed, str(trip)
    assert trip.unit == trip.to_dict()["unit"] == unit
    assert trip.volume.cad == pytest.approx(written["mm", ending][1].volume.cad, rel=1e-6)


@pytest.mark.parametrize("unit", MILLIMETRES)
def test_a_step_file_holds_numbers_of_its_unit(written, unit):
    in_unit, in_mm = (step_corners(written[each, "step"][0]) for each in (unit, "mm"))
    # the writer rounds to 12 decimals
    assert in_unit * MILLIMETRES[unit] == pytest.approx(in_mm, abs=1e-12 * MILLIMETRES[unit] + 1e-12)
    name = {"mm": "SI_UNIT(.MILLI.,.METRE.)", "m": "SI_UNIT($,.METRE.)", "in": "CONVERSION_BASED_UNIT('INCH'"}[unit]
    assert name in written[unit, "step"][0].read_text()


@pytest.mark.parametrize("unit", MILLIMETRES)
def test_validation_properties_and_uncertainty_are_in_the_unit_of_the_file(vane, written, unit):
    path, trip = written[unit, "step"]
    text, scale = path.read_text().replace("\n", ""), 1e3 / MILLIMETRES[unit]
    volume = float(re.search(r"VOLUME_MEASURE\(\s*([-+.E0-9]+)\)", text)[1])
    assert volume == pytest.approx(vane.properties.volume * scale**3, rel=1e-10)
    centre = re.search(r"CARTESIAN_POINT\('centre point',\(([-+.E0-9, ]+)\)\)", text)[1]
    assert [float(x) for x in centre.split(",")] == pytest.approx(vane.properties.centroid * scale, rel=1e-9)
    uncertainty = float(re.search(r"UNCERTAINTY_MEASURE_WITH_UNIT\(LENGTH_MEASURE\(([-+.E0-9]+)\)", text)[1])
    assert uncertainty * MILLIMETRES[unit] >= trip.edges.max_gap


@pytest.mark.parametrize("unit", MILLIMETRES)
def test_opencascade_reads_a_file_of_any_unit_in_millimetres(written, unit):
    for ending in ("step", "igs"):
        opened = read_cad_file(written[unit, ending][0])
        assert opened.unit == unit
    assert [read_stl(written[unit, "stl"][0])[1], read_3mf(written[unit, "3mf"][0])[1]] == [unit, unit]


def test_an_stl_file_holds_numbers_of_its_unit(written):
    inches, millimetres = (
        np.frombuffer(written[unit, "stl"][0].read_bytes()[84:], dtype=np.uint8) for unit in ("in", "mm")
    )
    assert len(inches) == len(millimetres)
    first = [each[12:48].view("<f4").astype(float) for each in (inches, millimetres)]
    assert first[0] * 25.4 == pytest.approx(first[1], rel=1e-6)


def test_units_that_a_file_cannot_have_are_refused(vane, tmp_path):
    with pytest.raises(CadError, match="choose mm, m or in"):
        cad.write(vane, tmp_path / "vane.step", unit="ft")
    with pytest.raises(CadError, match="which states no unit and is read in millimetres"):
        cad.write(vane, tmp_path / "vane.brep", unit="in")
    assert not list(tmp_path.iterdir())
