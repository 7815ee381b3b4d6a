"""What cannot be meshed is refused with a paragraph that says why, and leaves nothing."""

import subprocess
import sys

import pytest

from bladewright.errors import MeshError
from bladewright.meshing import gmsh_process
from bladewright.meshing.names import face_names, group_of
from bladewright.meshing.periodicity import periodicity

needs_gmsh = pytest.mark.usefixtures("gmsh")
KILLED = """import os, signal
print("Info: about to fall", flush=True)
os.kill(os.getpid(), signal.SIGKILL)
"""


@needs_gmsh
@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"size": 0.0}, ["size is 0", "above 0"]),
        ({"size": -0.1}, ["size is -0.1", "above 0"]),
        ({"size": float("nan")}, ["size is nan"]),
        ({"size": 1.5}, ["size is 1.5", "at most 1"]),
        ({"size": 1e-4}, ["tetrahedra are expected", "at most 5,000,000", "raise size to"]),
        ({"size": 0.3, "smallest": 0.5}, ["smallest is 0.5", "0.3"]),
        ({"smallest": 0.0}, ["smallest is 0"]),
        ({"size": 0.3, "curvature": 0.0}, ["curvature is 0", "between 1 and 1000"]),
        ({"unit": "inch"}, ["'inch'", "m or mm"]),
    ],
    ids=str,
)
def test_sizes_that_no_mesh_has_are_refused(options, words, cascade, tmp_path):
    with pytest.raises(MeshError) as caught:
        cascade.mesh(tmp_path / "mesh.msh", **options)
    for word in words:
        assert word in str(caught.value)
    assert list(tmp_path.iterdir()) == []


def test_the_size_that_a_refusal_names_is_taken(cascade):
    from bladewright.meshing.sizes import MAX_TETRAHEDRA, sizes

    with pytest.raises(MeshError) as caught:
        sizes(cascade.passage, size=1e-3)
    named = float(str(caught.value).rpartition("raise size to ")[2])
    assert 0.8 * MAX_TETRAHEDRA < sizes(cascade.passage, size=named).expected <= MAX_TETRAHEDRA


@pytest.mark.parametrize("name", ["mesh.vtk", "mesh", "mesh.step"])
def test_an_unknown_ending_is_refused(name, cascade, tmp_path):
    with pytest.raises(MeshError, match=r"choose \.msh, \.su2, \.cgns"):
        cascade.mesh(tmp_path / name)


def test_without_gmsh_the_way_to_install_it_is_named(cascade, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "gmsh", None)
    with pytest.raises(MeshError, match=r"pip install 'bladewright\[mesh\]'"):
        cascade.mesh(tmp_path / "mesh.msh")


@needs_gmsh
def test_a_missing_library_of_the_system_is_named(cascade, tmp_path, monkeypatch):
    (tmp_path / "gmsh.py").write_text("raise OSError('libGLU.so.1: cannot open shared object file')\n")
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(MeshError, match=r"libGLU\.so\.1.*apt-get install"):
        cascade.mesh(tmp_path / "mesh.msh")


@needs_gmsh
def test_a_gmsh_that_falls_is_an_error_with_its_last_words(cascade, tmp_path, monkeypatch):
    (tmp_path / "falling.py").write_text(KILLED)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(gmsh_process, "WORKER", "falling")
    heard = []
    with pytest.raises(MeshError, match=r"ended by signal 9.*about to fall") as caught:
        cascade.mesh(tmp_path / "mesh.msh", log=heard.append)
    assert heard == ["Info: about to fall"]
    assert "about to fall" in caught.value.__notes__[0]
    assert not (tmp_path / "mesh.msh").exists()


@needs_gmsh
def test_the_process_ends_with_an_interruption(cascade, tmp_path, monkeypatch):
    started = []

    class Seen(subprocess.Popen):
        def __init__(self, *words, **options):
            super().__init__(*words, **options)
            started.append(self)

    monkeypatch.setattr(gmsh_process.subprocess, "Popen", Seen)

    def interrupted(_):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        cascade.mesh(tmp_path / "mesh.msh", progress=interrupted)
    assert started[0].returncode == -9
    assert list(tmp_path.iterdir()) == []


@needs_gmsh
def test_a_file_of_another_body_is_refused(cascade, rotor, tmp_path):
    from bladewright import meshing

    with pytest.raises(MeshError, match="tip"):
        meshing.mesh(cascade.step, tmp_path / "mesh.msh", passage=rotor.passage, size=0.3)
    with pytest.raises(MeshError, match="cannot be read"):
        meshing.mesh(tmp_path / "none.step", tmp_path / "mesh.msh", passage=rotor.passage, size=0.3)
    other = tmp_path / "other.step"
    other.write_text("ISO-10303-21;")
    with pytest.raises(MeshError, match="0 closed shells"):
        meshing.mesh(other, tmp_path / "mesh.msh", passage=rotor.passage, size=0.3)


def test_names_come_in_the_order_of_the_shell_whatever_the_lines():
    text = "#3=ADVANCED_FACE('inlet',(#9),#8,.T.);\n#2 = ADVANCED_FACE('out\nlet',(#7),#6,.F.);\n"
    assert face_names(text + "#1=CLOSED_SHELL('p',(#2,\n #3));") == ("outlet", "inlet")


def test_a_piece_belongs_to_the_group_it_is_named_after():
    assert group_of("hub_upper_blade") == "hub_upper"
    assert group_of("inlet_lower") == "inlet"
    assert group_of("blade_upper") == "blade_upper"
    assert group_of("tip") == "tip"


def test_boundaries_that_are_no_motion_of_each_other_are_refused(rotor):
    faces = dict(rotor.passage.surfaces)
    with pytest.raises(MeshError, match="off any rotation"):
        periodicity({**faces, "periodic_lower": faces["outlet"], "periodic_upper": faces["inlet"]})
    with pytest.raises(MeshError, match="periodic_lower"):
        periodicity({"inlet": faces["inlet"]})
