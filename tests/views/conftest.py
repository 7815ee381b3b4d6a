"""A design of every kind that is drawn, what it builds and the sheet of it."""

import pytest

from bladewright.blade.design.families import prismatic
from bladewright.blade.design.flow_path import Channel
from bladewright.blade.design.unified import UnifiedBlade
from bladewright.files.examples import example_text
from bladewright.files.reading import design_from, parsed
from bladewright.section.unified import UnifiedSection
from bladewright.views.picture import sheet

VANE = UnifiedSection(
    name="vane",
    length_unit="cm",
    description="A prismatic turbine vane",
    pitch=5.75,
    axial_chord=3.6,
    stagger=-52.0,
    metal_angle_in=0.0,
    metal_angle_out=-74.0,
    tangent_in=0.6,
    tangent_out=0.9,
    leading_edge_radius=0.11,
    trailing_edge_radius=0.02,
    thickness_upper=(0.16, 0.26, 0.16, 0.05),
    thickness_lower=(0.1, 0.12, 0.08, 0.03),
    span=6.0,
)
IMPELLER = UnifiedBlade(
    name="impeller",
    length_unit="mm",
    blade_count=14,
    stagger=(35.0, 45.0),
    metal_angle_in=(32.0, 58.0),
    metal_angle_out=40.0,
    tangent_in=0.3,
    tangent_out=0.3,
    leading_edge_radius=0.005,
    trailing_edge_radius=0.005,
    thickness_upper=(0.015, (0.02, 0.012), 0.012),
    thickness_lower=(0.015, (0.02, 0.012), 0.012),
    channel=Channel(
        leading_edge=((0, 20), (0, 50)),
        trailing_edge=((45, 100), (37, 100)),
        hub=((25, 20), (44, 45)),
        shroud=((22, 52), (36, 66)),
    ),
)
DESIGNS = {
    "fan": lambda: design_from(parsed(example_text("fan-rotor"), "fan"), "fan"),
    "impeller": lambda: IMPELLER,
    "cascade": lambda: prismatic(VANE),
    "section": lambda: VANE,
}
BLADES = ("fan", "impeller", "cascade")


class Drawn:
    """A design, what it builds and its sheet, each made once."""

    def __init__(self, name):
        self.name = name
        self.design = DESIGNS[name]()
        self.built = self.design.build()
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
