"""Passages of every kind of machine, with and without a gap."""

from dataclasses import dataclass
from functools import cache

from bladewright.blade.native.blade import Blade
from bladewright.domain.build import passage
from bladewright.domain.passage import Passage

from . import COARSE, built, example
from .sectioned import PLATE

UNIFIED = {
    "rotor": ("nasa-rotor-67", {"tolerance": COARSE}, {}),
    "shrouded fan with a gap": ("fan-rotor", {"tip_clearance": (0.4, 0.6), "hub_clearance": None}, {}),
    "impeller with a gap": ("centrifugal-impeller", {"tip_clearance": (0.3, 0.2), "hub_clearance": None}, {}),
    "inflow turbine": ("radial-turbine", {"tip_clearance": None, "tolerance": COARSE}, {"downstream": 0.8}),
    "propeller": ("propeller", {"tip_clearance": None, "tolerance": COARSE}, {"outlet_angle": -30.0}),
    "cascade": ("vki-ls89", {"tolerance": COARSE}, {"upstream": 0.7, "outlet_angle": -60.0}),
    "cantilevered stator": ("aachen-stator", {"hub_clearance": 0.5}, {"inlet_angle": 5.0}),
}
"""built-in design, what is changed in it, and what is asked of the passage"""
SECTIONED = {
    "axial rotor": (example("core-rotor"), {}),
    "plate with faces at both edges": (PLATE, {"outlet_angle": -10.0, "downstream": 2.5}),
    "vanes with sharp edges": (example("vaned-diffuser"), {"upstream": 0.4}),
    "wedge diffuser": (example("wedge-diffuser"), {}),
}
"""design, and what is asked of the passage: every kind of edge, in axial, radial and linear machines"""


@dataclass(frozen=True)
class Case:
    """A blade, its passage, and what was asked of that."""

    blade: Blade
    passage: Passage
    asked: dict


@cache
def passage_case(name):
    """The passage of a name above, about the blade that is built once."""
    if name in UNIFIED:
        of, changes, asked = UNIFIED[name]
        # at a coarse tolerance the trimmed tip of the impeller takes ten times as long to integrate
        blade = built(example(of).changed(changes))
    else:
        design, asked = SECTIONED[name]
        blade = built(design.changed("tolerance", COARSE))
    return Case(blade=blade, passage=passage(blade, **asked), asked=asked)
