"""A design of every kind that is drawn, what it builds and the sheet of it."""

from functools import cached_property
from importlib import import_module

import pytest

from bladewright.blade.design.families import prismatic
from bladewright.section.checks import UNITS
from bladewright.views.picture import sheet
from bladewright.views.solid import draw_solid
from bladewright.views.style import lengths_in
from machines import COARSE, built, example
from machines.unified import DRAWN_IMPELLER as IMPELLER
from machines.unified import VANE

DESIGNS = {
    "fan": example("fan-rotor").changed("tolerance", COARSE),
    "impeller": IMPELLER,
    "cascade": prismatic(VANE).changed("tolerance", COARSE),
    "section": VANE,
}
FAN = pytest.param("fan", marks=pytest.mark.slow)
BLADES = ("impeller", "cascade", FAN)


def small_solid(axes, blade, *, neighbours, **_):
    """The view in space, of a sheet, on few pixels: what it shows is asked in test_solid.py and test_raster.py."""
    draw_solid(axes, blade, neighbours=neighbours, width=200)


class Drawn:
    """A design, what it builds and its sheet, each made once."""

    def __init__(self, name):
        self.name = name
        self.design = DESIGNS[name]
        self.unit = self.design.length_unit
        self.per_metre = 1.0 / UNITS[self.unit]
        self.built = built(self.design)
        with pytest.MonkeyPatch.context() as small:
            # pixels of the view in space are counted in test_files.py alone
            small.setattr(import_module("bladewright.views.picture"), "draw_solid", small_solid)
            self.figure = sheet(self.design, self.built)

    @cached_property
    def painted(self):
        """The sheet, with every text and pixel where it is."""
        self.figure.canvas.draw()
        return self.figure

    def panel(self, title):
        return next(axes for axes in self.figure.axes if axes.get_title(loc="left").startswith(title))


_DRAWN = {}


def _drawn(name):
    if name not in _DRAWN:
        _DRAWN[name] = Drawn(name)
    return _DRAWN[name]


def _in_its_unit(name):
    """The drawing, with everything that a test asks for in the unit in which it is drawn."""
    with lengths_in(_drawn(name).unit):
        yield _drawn(name)


@pytest.fixture(params=[*BLADES, "section"])
def drawn(request):
    yield from _in_its_unit(request.param)


@pytest.fixture(params=BLADES)
def blade_drawn(request):
    yield from _in_its_unit(request.param)


@pytest.fixture
def section_drawn():
    return _drawn("section")


@pytest.fixture
def cascade_drawn():
    return _drawn("cascade")
