"""IGES files: solids or trimmed surfaces, header, names, unit."""

from collections import Counter

import pytest

import bladewright
from bladewright import cad
from bladewright.cad.reading import read_cad_file


def entities(path):
    """How many entities of each type a file has; each has two lines in the directory."""
    directory = [line for line in path.read_text("ascii").splitlines() if line[72] == "D"]
    return Counter(int(line[:8]) for line in directory[::2])


def global_section(path):
    return "".join(line[:72] for line in path.read_text("ascii").splitlines() if line[72] == "G")


@pytest.fixture(scope="module")
def iges(rotor, tmp_path_factory):
    path = tmp_path_factory.mktemp("iges") / "rotor.igs"
    return path, cad.write(rotor, path)


@pytest.fixture(scope="module")
def surfaces(rotor, tmp_path_factory):
    path = tmp_path_factory.mktemp("iges") / "rotor.iges"
    return path, cad.write(rotor, path, solid=False)


def test_an_iges_file_holds_one_manifold_solid(iges):
    path, trip = iges
    assert trip.passed, str(trip)
    assert trip.schema == "5.3 solid"
    counts = entities(path)
    # 186 manifold solid, 514 shell, 510 face, 128 spline surface, 120 surface of revolution
    assert (counts[186], counts[514], counts[510], counts[128], counts[120]) == (1, 1, 4, 2, 2)


def test_trimmed_surfaces_are_written_on_request_and_close_when_sewn(surfaces):
    path, trip = surfaces
    assert trip.passed, str(trip)
    assert trip.schema == "5.3 trimmed surfaces"
    counts = entities(path)
    assert (counts[186], counts[144]) == (0, 4)


def test_trimmed_surfaces_with_collapsed_edges_close_too(bodies, tmp_path):
    trip = cad.write(bodies["ruled ends"], tmp_path / "extended.igs", solid=False)
    assert trip.passed, str(trip)


def test_the_global_section_says_what_it_is_who_made_it_and_in_millimetres(rotor, iges):
    told = global_section(iges[0])
    for text in (rotor.name, rotor.author, rotor.organisation, f"bladewright {bladewright.__version__}"):
        assert f"{len(text)}H{text}," in told
    assert ",2,2HMM," in told
    assert iges[1].unit == "mm"


@pytest.mark.parametrize("kind", ["iges", "surfaces"])
def test_faces_are_named_by_their_labels(rotor, kind, request):
    path, _ = request.getfixturevalue(kind)
    assert sorted(read_cad_file(path).names.values()) == sorted(rotor.surfaces)
