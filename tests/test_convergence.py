"""The native curves and surfaces of every family come nearer to the exact ones by the order of their degree."""

from dataclasses import replace

import numpy as np
import pytest

from bladewright.files.families import FAMILIES as IN_FILES
from bladewright.section.laws import Span
from machines import built
from machines.families import FAMILIES

ORDER = 6
"""of interpolation by curves of degree 5"""
MARGIN = 0.5
"""what an order observed may lack: small edges are still unresolved by the first meshes"""
SECTIONS = [name for name in FAMILIES if name.endswith("-section") and name != "unified-section"]
"""the sides of a unified section are B-splines by definition, and interpolate nothing"""
BLADES = [name for name in FAMILIES if not name.endswith("-section")]
U, V = (np.arange(200) + 0.37) / 200, (np.arange(12) + 0.41) / 12
"""places apart from knots and interpolation sites"""


def halved(knots):
    spans = np.unique(knots)
    return np.sort(np.concatenate([knots, (spans[1:] + spans[:-1]) / 2.0]))


def rms(misses):
    return np.sqrt(np.mean(np.sum(misses**2, axis=-1)))


def observed(errors):
    """The better order of the last two halvings of a mesh."""
    return np.max(np.log2(np.array(errors[-3:-1]) / errors[-2:]))


def test_every_family_of_files_takes_part():
    assert {name: type(design) for name, design in FAMILIES.items()} == IN_FILES


@pytest.mark.parametrize("name", SECTIONS)
def test_the_curves_of_a_section_converge_with_order_six(name):
    design, places = FAMILIES[name], (np.arange(1500) + 0.37) / 1500
    knots, errors = built(design.changed("tolerance", 1e-3)).knots, []
    points = design.section.outline(Span(np.zeros(1))).points(places)
    # down to where rounding is seen
    while not errors or (errors[-1] > 1e-13 and len(errors) < 9):
        section = design.build(knots=knots)
        cos, sin = np.cos(section.stagger), np.sin(section.stagger)
        sides = [1e-3 * design.chord * side[0] @ np.array([[cos, sin], [-sin, cos]]) for side in points]
        misses = [section.curves[at](places) - side for at, side in zip(("upper", "lower"), sides, strict=True)]
        errors.append(rms(np.stack(misses)) / section.chord)
        knots = replace(knots, sides=halved(knots.sides))
    assert observed(errors) > ORDER - MARGIN


@pytest.mark.parametrize("name", BLADES)
def test_the_surfaces_of_a_blade_converge_with_order_six(name):
    coarse, errors = built(FAMILIES[name].changed("tolerance", 1e-3)), []
    knots, stations = replace(coarse.knots, v=halved(halved(coarse.knots.v)), sections=None), coarse.exact.sections(V)
    # down to how well stream surfaces are known
    while not errors or (errors[-1] > 1e-11 and len(errors) < 6):
        blade = FAMILIES[name].build(knots=knots)
        misses = [
            side.grid(U, V).swapaxes(0, 1) - points
            for side, points in zip(blade.sides, stations.points(U), strict=True)
        ]
        errors.append(rms(np.stack(misses)) / blade.chord)
        knots = replace(knots, u=halved(knots.u), v=halved(knots.v))
    assert observed(errors) > ORDER - MARGIN
