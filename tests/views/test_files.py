"""Picture files: every suffix, the same bytes each time, whole or not at all, and clear refusals."""

import subprocess
import sys

import numpy as np
import pytest
from matplotlib import rcParams
from matplotlib.figure import Figure
from matplotlib.image import imread

from bladewright import views
from bladewright.errors import DesignError, FileError
from bladewright.views.pages import write_figure
from bladewright.views.style import drawing_style

STARTS = {".png": b"\x89PNG", ".svg": b"<?xml", ".pdf": b"%PDF"}


def test_a_section_is_drawn_and_the_callers_settings_stay(section_drawn, tmp_path):
    before = dict(rcParams)
    views.picture(section_drawn.design, tmp_path / "vane.svg", blade=section_drawn.built)
    assert (tmp_path / "vane.svg").read_bytes().startswith(STARTS[".svg"])
    assert [each.name for each in tmp_path.iterdir()] == ["vane.svg"]
    assert dict(rcParams) == before


@pytest.mark.parametrize("suffix", list(STARTS))
def test_the_same_figure_gives_the_same_bytes_in_every_format(tmp_path, suffix):
    files = [tmp_path / f"{index}{suffix}" for index in range(2)]
    for file in files:
        with drawing_style():
            figure = Figure(figsize=(2.0, 2.0))
            figure.add_subplot().plot([0.0, 1.0], [0.0, 2.0], marker="o")
            write_figure(figure, file, 50)
    assert files[0].read_bytes() == files[1].read_bytes()
    assert files[0].read_bytes().startswith(STARTS[suffix])


@pytest.mark.slow
def test_a_blade_is_drawn_sixteen_hundred_pixels_wide_or_more(cascade_drawn, tmp_path):
    views.picture(cascade_drawn.built, tmp_path / "sheet.PNG")
    image = imread(tmp_path / "sheet.PNG", format="png")
    assert image.shape[1] >= 1600
    assert 0.02 < (image[..., :3].min(axis=-1) < 0.8).mean() < 0.5


@pytest.mark.slow
def test_the_blade_alone_is_drawn_in_its_row(cascade_drawn, tmp_path):
    views.blade_view(cascade_drawn.built, tmp_path / "blade.png")
    image = imread(tmp_path / "blade.png")
    ink = (image[..., :3].min(axis=-1) < 0.97).mean()
    assert 0.1 < ink < 0.9
    assert ((image[..., 2] > 1.25 * image[..., 0]).mean()) > 0.01


def test_a_section_has_no_view_in_space(section_drawn, tmp_path):
    with pytest.raises(DesignError, match=r"a Section was given: only a blade has a 3D view; .* prismatic"):
        views.blade_view(section_drawn.built, tmp_path / "blade.png")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("draw", [views.picture, views.blade_view])
@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("vane.jpg", r"vane.jpg' ends in '.jpg': a picture is drawn as .png, .svg, .pdf"),
        ("vane", r"vane' has no ending: a picture is drawn as .png, .svg, .pdf"),
        ("there/vane.png", r"there is no directory '.*there'; make it first"),
        ("folder.png", r"folder.png' is a directory: name the picture"),
    ],
)
def test_a_path_that_will_not_do_is_refused_before_anything_is_built(draw, name, reason, tmp_path):
    (tmp_path / "folder.png").mkdir()
    with pytest.raises(FileError, match=reason):
        draw(None, tmp_path / name)
    assert [each.name for each in tmp_path.iterdir()] == ["folder.png"]


def test_a_place_that_takes_no_files_is_refused_with_the_reason():
    with pytest.raises(FileError, match=r"'/proc/vane.png' cannot be written: .*; name another file"):
        write_figure(Figure(), "/proc/vane.png", 50)


def test_a_file_is_replaced_whole_or_kept(tmp_path, monkeypatch):
    file = tmp_path / "vane.png"
    file.write_bytes(b"old")
    figure = Figure(figsize=(1.0, 1.0))
    with monkeypatch.context() as broken:
        broken.setattr("os.fsync", lambda *_: (_ for _ in ()).throw(OSError(28, "No space left on device")))
        with pytest.raises(FileError, match="no space left on device"):
            write_figure(figure, file, 50)
    assert file.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [file]
    write_figure(figure, file, 50)
    assert np.allclose(imread(file)[..., :3], 1.0)
    assert list(tmp_path.iterdir()) == [file]


def test_drawing_loads_neither_opencascade_nor_pyplot():
    program = (
        "import sys, bladewright.views.picture\nprint(*{'OCP', 'cadquery', 'matplotlib.pyplot'} & set(sys.modules))"
    )
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True, timeout=120)
    assert run.stdout.strip() == ""
