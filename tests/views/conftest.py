"""A design of every kind that is drawn, what it builds and the sheet of it."""

import pytest

from bladewright.blade.design.families import prismatic
from bladewright.views.picture import sheet
from machines import COARSE, built, example
from machines.unified import DRAWN_IMPELLER as IMPELLER
from machines.unified import VANE

DESIGNS = {
    "fan": example("fan-rotor").changed("tolerance", COARSE),
    "impeller": IMPELLER,
    "cascade": prismatic(VANE).changed("tolerance", COARSE),
    "section": VANE,
}
BLADES = ("fan", "impeller", "cascade")


class Drawn:
    """A design, what it builds and its sheet, each made once."""

    def __init__(self, name):
        self.name = name
        self.design = DESIGNS[name]
        self.built = built(self.design)
        self.figure = sheet(self.design, self.built)
        self.figure.canvas.draw()

    def panel(self, title):
        return next(axes for axes in self.figure.axes if axes.get_title(loc="left").startswith(title))


_DRAWN = {}


def _drawn(name):
    if name not in _DRAWN:
        _DRAWN[name] = Drawn(name)
    return _DRAWN[name]


@pytest.fixture(params=list(DESIGNS))
def drawn(request):
    return _drawn(request.param)


@pytest.fixture(params=BLADES)
def blade_drawn(request):
    return _drawn(request.param)


@pytest.fixture
def section_drawn():
    return _drawn("section")


@pytest.fixture
def cascade_drawn():
    return _drawn("cascade")
