"""Passages carry complex numbers: derivatives of volumes and poles against central differences at held knots."""

import numpy as np
import pytest

from bladewright.domain.build import passage
from machines.passages import passage_case

PARAMETERS = {
    "rotor": ["stagger[4]"],
    "impeller with a gap": ["tip_clearance[0]"],
    "cascade": ["pitch", "leading_edge_radius"],
    "cantilevered stator": ["hub_clearance"],
}


def volume_and_poles(case, design):
    """Poles, and the volume where no trimmed tip makes it long to integrate."""
    made = passage(design.build(knots=case.blade.knots), knots=case.passage.knots, **case.asked)
    poles = [made.surfaces[name].control_points.ravel() / case.blade.chord for name in ("hub_upper", "blade_upper")]
    if "tip" not in made.surfaces:
        poles.append(np.atleast_1d(made.properties.volume / case.blade.chord**3))
    return np.concatenate(poles)


@pytest.mark.parametrize(
    ("name", "path"),
    [
        pytest.param(name, path, marks=[pytest.mark.slow] if name == "rotor" else [])
        for name, paths in PARAMETERS.items()
        for path in paths
    ],
)
def test_volume_and_poles_follow_the_parameters(name, path):
    case = passage_case(name)
    design = case.blade.design
    value = design.parameters()[path]
    exact = np.imag(volume_and_poles(case, design.changed(path, value + 1e-30j))) / 1e-30
    step = 2e-4 * max(1.0, abs(value)) if "radius" not in path and "thickness" not in path else 1e-4 * value

    def difference(h):
        ahead, behind = (volume_and_poles(case, design.changed(path, value + sign * h)) for sign in (1, -1))
        return (ahead - behind) / (2.0 * h)

    # Richardson's step leaves an error of the fourth power of the step, and rounding over it
    found = (4.0 * difference(step / 2.0) - difference(step)) / 3.0
    scale = np.max(np.abs(exact))
    np.testing.assert_allclose(found, exact, rtol=0, atol=1e-6 * scale)
    assert scale > 0.0
