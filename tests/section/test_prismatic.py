"""Sections of every family as prismatic blades."""

import numpy as np
import pytest

from bladewright.blade.design.families import prismatic
from machines.sections import EXAMPLES

PLANAR = {
    name: EXAMPLES[name].design.changed("span", 20.0)
    for name in (
        "suction and pressure side of a stator",
        "wedge diffuser with a back face",
        "curvature meanline that bends back, blunt behind",
        "mixed camber line with a sharp leading edge",
        "camber-angle",
        "points-lens",
        "flat-plate-elliptic",
    )
}


@pytest.mark.parametrize("name", PLANAR)
def test_a_section_of_every_family_extrudes_to_a_prism(name):
    design = PLANAR[name]
    section, blade = design.build(), prismatic(design).build()
    u = np.linspace(0.0, 1.0, 41)
    for side in ("upper", "lower"):
        built = blade.surfaces[side](u, 0.3)
        assert built[:, 2] == pytest.approx(6e-3, abs=1e-12)
        assert np.max(np.abs(built[:, :2] - section.curves[side](u))) < 1e-6 * section.chord
    assert blade.properties.volume == pytest.approx(float(section.area) * 20e-3, rel=1e-5)
    assert blade.conformance.kept, blade.conformance
