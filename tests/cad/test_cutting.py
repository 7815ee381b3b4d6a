"""The second way to a passage: the kernel cuts the blade out of a sector with exact walls."""

import numpy as np
import pytest

import bladewright as bw
from bladewright import cad
from bladewright.cad.closure import closure
from bladewright.cad.reading import read_cad_file
from bladewright.errors import CadError
from bladewright.nurbs.revolution import arc
from machines import COARSE, built, example
from machines.closed_form_sectors import Cuttable, sector, standing
from machines.sectioned import PLATE


@pytest.fixture(scope="module")
def passage():
    return Cuttable(periodic_sector=sector())


@pytest.fixture(scope="module")
def cut(passage):
    return cad.cut_passage(passage)


def test_what_is_left_is_one_closed_valid_solid_with_a_hole(cut):
    closed = closure(cut.solid.wrapped)
    assert (closed.solids, closed.shells, closed.free_edges, closed.non_manifold_edges) == (1, 1, 0, 0)
    assert closed.valid
    # twelve edges of the sector and six of the blade; hub and shroud have a ring more than a disc has
    assert (len(cut.solid.Vertices()), len(cut.solid.Edges()), len(cut.solid.Faces())) == (12, 18, 8)


def test_its_faces_have_the_names_of_what_they_were(cut):
    assert sorted(cut.body.faces) == sorted(
        ["hub", "shroud", "inlet", "outlet", "periodic_upper", "periodic_lower", "blade_upper", "blade_lower"]
    )


def test_its_volume_is_that_of_the_sector_less_the_blade(passage, cut):
    native = passage.periodic_sector.properties.volume - standing().properties.volume
    assert cut.properties.volume == pytest.approx(native, rel=1e-6)
    # the sector's own edges lie 7e-9 m off its walls, and the bound covers that
    assert abs(cut.properties.volume - native) <= cut.properties.volume_error <= 1e-6 * native


def test_its_gaps_are_those_of_the_sector_and_of_the_blades_ends(cut):
    assert cut.gap < 2e-8


def test_its_centroid_is_the_sectors_without_the_blades(passage, cut):
    whole, blade = passage.periodic_sector.properties, standing().properties
    rest = (whole.volume * whole.centroid - blade.volume * blade.centroid) / (whole.volume - blade.volume)
    np.testing.assert_allclose(cut.properties.centroid, rest, atol=1e-7)


def test_its_step_file_keeps_solid_volume_and_names(cut, tmp_path):
    path = tmp_path / "passage.step"
    cad.write_cut(cut, path)
    opened = read_cad_file(path)
    assert sorted(opened.names.values()) == sorted(cut.body.faces)
    assert [each.name for each in tmp_path.iterdir()] == ["passage.step"]


def test_another_format_is_refused_and_leaves_nothing(cut, tmp_path):
    with pytest.raises(CadError, match="written to STEP only"):
        cad.write_cut(cut, tmp_path / "passage.igs")
    assert not list(tmp_path.iterdir())


def test_a_blade_that_ends_within_its_sector_is_refused(passage):
    with pytest.raises(CadError, match="the blade does not stand within its sector"):
        cad.cut_passage(passage, span=-0.05)


def test_a_sector_that_winds_more_than_a_turn_is_refused():
    class Winding:
        name = "pump"

        @property
        def periodic_sector(self):
            return arc((0.0, 0.0), 1.0, 0.0, 7.0)

    with pytest.raises(CadError, match="one face within a turn"):
        cad.cut_passage(Winding())


QUICK = ("vki-ls89",)
LONG = (
    *("nasa-rotor-67", "aachen-stator", "compressor-stator", "fan-rotor", "centrifugal-impeller", "radial-turbine"),
    *("backswept-impeller", "wedge-diffuser", "vaned-diffuser"),
)


@pytest.mark.parametrize("name", [*QUICK, *(pytest.param(name, marks=pytest.mark.slow) for name in LONG)])
def test_patches_and_cut_enclose_the_same_volume(name):
    # the patches lie within 1e-7 of the chord of the exact walls
    passage = bw.passage(built(example(name).changed("tolerance", COARSE) if name in QUICK else example(name)))
    cut = cad.cut_passage(passage)
    native = float(passage.properties.volume)
    assert cut.properties.volume == pytest.approx(native, rel=1e-8)
    assert cut.properties.volume_error < 1e-6 * native


def test_a_blade_with_faces_at_its_edges_is_cut_out_with_them():
    edges = ("leading_edge", "trailing_edge")
    passage = bw.passage(built(PLATE.changed("tolerance", COARSE)))
    cut = cad.cut_passage(passage)
    assert {f"blade_{edge}" for edge in edges} <= set(cut.body.faces)
    # the walls of a cascade are planes for both
    assert cut.properties.volume == pytest.approx(float(passage.properties.volume), rel=1e-9)
