"""Passages of every kind of machine, with and without a gap, built once a session."""

from dataclasses import dataclass
from functools import cache
from importlib import resources

import pytest

from bladewright.blade.native.blade import Blade
from bladewright.domain.build import passage
from bladewright.domain.passage import Passage
from bladewright.files.reading import read_design

CASES = {
    "rotor": ("nasa-rotor-67", {}, {}),
    "shrouded fan with a gap": ("fan-rotor", {"tip_clearance": (0.4, 0.6), "hub_clearance": None}, {}),
    "impeller with a gap": ("centrifugal-impeller", {"tip_clearance": (0.3, 0.2), "hub_clearance": None}, {}),
    "inflow turbine": ("radial-turbine", {"tip_clearance": None}, {"downstream": 0.8}),
    "propeller": ("propeller", {"tip_clearance": None}, {"outlet_angle": -30.0}),
    "cascade": ("vki-ls89", {}, {"upstream": 0.7, "outlet_angle": -60.0}),
    "cantilevered stator": ("aachen-stator", {"hub_clearance": 0.5}, {"inlet_angle": 5.0}),
}
"""built-in design, what is changed in it, and what is asked of the passage"""


@dataclass(frozen=True)
class Case:
    blade: Blade
    passage: Passage
    asked: dict


@cache
def made(name: str) -> Case:
    design, changes, asked = CASES[name]
    file = resources.files("bladewright") / "examples" / f"{design}.toml"
    blade = read_design(file).changed(changes).build()
    return Case(blade=blade, passage=passage(blade, **asked), asked=asked)


@pytest.fixture(scope="session", params=list(CASES))
def case(request):
    return made(request.param)


@pytest.fixture(scope="session")
def rotor():
    return made("rotor")


@pytest.fixture(scope="session")
def cascade():
    return made("cascade")


@pytest.fixture(scope="session")
def fan():
    return made("shrouded fan with a gap")


@pytest.fixture(scope="session")
def gapped():
    return made("impeller with a gap")
