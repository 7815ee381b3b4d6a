"""Files that are not what their name says get one clear sentence, and standard output stays the user's."""

import ctypes

import pytest

from bladewright import cad
from bladewright.errors import CadError

ENDINGS = ["step", "stp", "igs", "iges", "brep", "stl", "3mf"]
PNG = b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR" + bytes(range(256)) * 40


@pytest.mark.parametrize("ending", ENDINGS)
def test_a_picture_is_refused(bodies, tmp_path, ending):
    path = tmp_path / f"vane.{ending}"
    path.write_bytes(PNG)
    with pytest.raises(CadError, match=rf"vane\.{ending} is not a whole"):
        cad.verify(path, bodies["linear"])


@pytest.mark.parametrize("content", [b"", b"   \n\n  "])
@pytest.mark.parametrize("ending", ENDINGS)
def test_an_empty_file_is_refused(bodies, tmp_path, ending, content):
    path = tmp_path / f"vane.{ending}"
    path.write_bytes(content)
    with pytest.raises(CadError, match="is empty"):
        cad.verify(path, bodies["linear"])


@pytest.mark.parametrize("ending", ENDINGS)
def test_a_directory_is_refused(bodies, tmp_path, ending):
    (tmp_path / f"vane.{ending}").mkdir()
    with pytest.raises(CadError, match="is a directory"):
        cad.verify(tmp_path / f"vane.{ending}", bodies["linear"])


def test_a_missing_file_is_refused(bodies, tmp_path):
    with pytest.raises(CadError, match=r"cannot read .*No such file"):
        cad.verify(tmp_path / "vane.step", bodies["linear"])


@pytest.mark.parametrize("name", ["vane.txt", "vane"])
def test_a_name_that_means_no_cad_format_is_refused_for_reading_and_writing(bodies, tmp_path, name):
    (tmp_path / name).write_text("anything")
    for door in (cad.verify, lambda path, built: cad.write(built, path)):
        with pytest.raises(CadError, match=r"CAD files end in \.step"):
            door(tmp_path / name, bodies["linear"])


@pytest.mark.parametrize("share", [0.02, 0.5, 0.97])
@pytest.mark.parametrize("ending", ["step", "igs", "brep", "stl", "3mf"])
def test_a_file_that_is_cut_off_is_refused(bodies, filed, tmp_path, ending, share):
    whole = filed("linear", ending)[0].read_bytes()
    path = tmp_path / f"vane.{ending}"
    path.write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(CadError, match=r"is not a whole|is broken|holds no face"):
        cad.verify(path, bodies["linear"])


def test_a_brep_file_that_lacks_any_of_its_last_parts_is_refused_before_opencascade_searches_for_them(rotor, tmp_path):
    path = tmp_path / "rotor.brep"
    cad.write(rotor, path, samples=100)
    whole = path.read_bytes()
    for missing in (3, *range(20, len(whole) // 25, 97)):
        path.write_bytes(whole[:-missing])
        with pytest.raises(CadError, match="breaks off before its last part"):
            cad.verify(path, rotor)
    path.write_bytes(whole.rstrip())
    assert cad.verify(path, rotor, samples=100).passed


def test_a_step_file_with_its_middle_missing_is_refused_or_fails(bodies, filed, tmp_path):
    whole = filed("linear", "step")[0].read_bytes()
    path = tmp_path / "vane.step"
    path.write_bytes(whole[: len(whole) // 3] + whole[-len(whole) // 3 :])
    try:
        trip = cad.verify(path, bodies["linear"])
    except CadError as error:
        assert str(path) in str(error)  # noqa: PT017
    else:
        assert not trip.passed


def test_a_huge_file_is_refused_before_it_is_read(bodies, tmp_path):
    path = tmp_path / "vane.step"
    with path.open("wb") as file:
        file.truncate(1_000_000_000)
    with pytest.raises(CadError, match="has 1000 MB: at most 500 MB"):
        cad.verify(path, bodies["linear"])


def test_the_kernel_prints_nothing(bodies, filed, tmp_path, capfd):
    cut = {ending: filed("linear", ending)[0].read_bytes()[:20_000] for ending in ("step", "igs")}
    nonsense = b"ISO-10303-21;\nHEADER;\nnonsense((;\nENDSEC;\nDATA;\n#1=;\nEND-ISO-10303-21;\n"
    flush = ctypes.CDLL(None).fflush
    flush(None)
    capfd.readouterr()
    for ending in ("step", "igs", "brep", "stl", "3mf"):
        cad.write(bodies["linear"], tmp_path / f"new.{ending}", samples=100, chordal_deviation=2e-4)
    for name, content in (("cut.step", cut["step"]), ("cut.igs", cut["igs"]), ("broken.step", nonsense)):
        (tmp_path / name).write_bytes(content)
        with pytest.raises(CadError, match=name):
            cad.verify(tmp_path / name, bodies["linear"])
    # what the kernel printed may still be in the buffers of the C library
    flush(None)
    assert capfd.readouterr() == ("", "")
