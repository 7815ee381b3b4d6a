"""What a notebook shows: picture and table of every kind of result, in HTML that loads nothing and draws in space."""

import shutil
import subprocess
from base64 import b64decode
from io import BytesIO

import numpy as np
import pytest
from matplotlib import pyplot as plt
from matplotlib.image import imread

from bladewright import cad
from bladewright.display import Shown
from bladewright.domain.row import Row
from bladewright.domain.section import section_passage
from bladewright.domain.sector import Sector
from bladewright.domain.wheel import Wheel
from bladewright.studies.optimum import Optimum
from bladewright.studies.pareto import ParetoSet
from bladewright.studies.sweep import sweep
from bladewright.views.html import frame, table
from bladewright.views.picture import sheet
from bladewright.views.shown import KINDS
from bladewright.views.view3d import blade_scene, view3d
from machines import COARSE, built
from machines.coarse import BLADES
from machines.fits import made
from machines.passages import passage_case
from machines.polars import recorded_polar
from machines.sectioned import DESIGNS
from machines.unified import VANE

from .page import Page


@pytest.fixture(scope="module")
def trip(tmp_path_factory):
    return cad.write(built(BLADES["cascade"]), tmp_path_factory.mktemp("trip") / "cascade.step", samples=100)


SHOWN = {
    "blade": lambda: built(BLADES["cascade"]),
    "passage": lambda: passage_case("plate with faces at both edges").passage,
    "section": lambda: built(VANE),
    "section passage": lambda: section_passage(built(VANE), 0.05),
    "polar": recorded_polar,
    "fit": lambda: made("linear"),
    "fit of a section": lambda: made("section"),
    "runs": lambda: sweep(VANE, {"stagger": (-52.0, -48.0)}, ["area", "chord"], samples=6, jobs=1),
}


def shown(name, request):
    return request.getfixturevalue("trip") if name == "round trip" else SHOWN[name]()


@pytest.mark.parametrize("name", [*SHOWN, "round trip"])
def test_a_notebook_shows_picture_and_table_and_loads_nothing(name, request):
    result = shown(name, request)
    html = result._repr_html_()
    page = Page(html)
    assert {"img", "table"} <= {tag for tag, _ in page.tags}
    assert page.loaded
    assert all(address.startswith("data:image/") for address in page.loaded)
    assert name.startswith(result.shown_as)
    assert len(html) < 400_000


@pytest.mark.parametrize("name", ["section passage", "round trip"])
def test_plot_returns_a_figure_that_pyplot_does_not_know_and_a_notebook_shows(name, request):
    figure = shown(name, request).plot()
    assert plt.get_fignums() == []
    assert imread(BytesIO(figure._repr_png_())).shape[1] > 400
    assert figure.axes


def test_every_kind_of_result_is_shown_and_a_blade_as_the_picture_of_show():
    direct = {Optimum, ParetoSet, *Shown.__subclasses__()}
    kinds = [Row, Sector, Wheel, *direct, *(below for kind in direct for below in kind.__subclasses__())]
    assert {kind.shown_as for kind in kinds if hasattr(kind, "shown_as")} == set(KINDS)
    assert KINDS["blade"].figure is KINDS["passage"].figure is sheet


@pytest.mark.parametrize("name", [*BLADES, "diffuser"])
def test_the_points_of_the_view_in_space_are_the_blades(name):
    blade = built(BLADES[name] if name in BLADES else DESIGNS[name].changed("tolerance", COARSE))
    scene = Page(view3d(blade_scene(blade), name)).scene
    grid = scene["grids"][0]
    packed = np.frombuffer(b64decode(grid["points"]), "<i2").reshape(grid["rows"], grid["columns"], 3)
    u = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, grid["rows"]))) / 2.0
    exact = 1e3 * blade.surfaces["upper"].grid(u, np.linspace(0.0, 1.0, grid["columns"]))
    np.testing.assert_allclose(packed * scene["step"], exact, atol=0.5001 * scene["step"])
    copies = [copy for each in scene["grids"] for copy in each["copies"]]
    pitch = 2.0 * np.pi / (blade.design.blade_count or 1)
    turns = {round(copy["turn"] / pitch, 9) for copy in copies if "turn" in copy}
    assert turns == ({-2, -1, 1, 2} if blade.design.blade_count else set())


def test_names_are_written_as_they_are_and_not_as_markup():
    name = 'R&D\'s <b>rotor</b> & "1" <script>'
    page = Page(frame(name, name, view3d(blade_scene(built(BLADES["cascade"])), name), table([(name, name)], (name,))))
    assert page.words.count(name) == 5
    assert [tag for tag, _ in page.tags].count("b") == 1
    assert name in [attrs.get("alt") for _, attrs in page.tags]


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("chromium") is None, reason="there is no chromium")
def test_the_view_in_space_draws_in_a_browser_without_network(tmp_path):
    blade = built(BLADES["rotor"])
    page, picture = tmp_path / "page.html", tmp_path / "page.png"
    view = view3d(blade_scene(blade), "rotor")
    # without the picture that is there before, only the script draws
    start, end = view.index('src="data:image'), view.index("></div>")
    page.write_text(f"<!doctype html><meta charset=utf-8><body>{view[:start]}{view[end:]}</body>")
    words = [
        "--headless",
        "--no-sandbox",
        "--disable-gpu",
        "--disable-quic",
        "--no-first-run",
        "--virtual-time-budget=4000",
    ]
    words += ["--disable-background-networking", "--host-resolver-rules=MAP * ~NOTFOUND", "--window-size=800,700"]
    run = ["chromium", *words, f"--screenshot={picture}", page.as_uri()]
    subprocess.run(run, check=True, capture_output=True, timeout=120)
    pixels = imread(picture)[..., :3]
    blue = (pixels[..., 2] > 1.3 * pixels[..., 0]).mean()
    assert 0.01 < blue < 0.3
    assert 0.1 < (pixels.min(axis=-1) < 0.97).mean() < 0.8
