"""Thirteen rows of a compressor in one flow path, rotors and stators in turn, each of 60 free numbers and its edges."""

import numpy as np

from bladewright.blade.design.families import CurvatureMeanlineBlade
from bladewright.blade.design.flow_path import FlowPath
from bladewright.blade.design.meridional_curve import ThroughPoints
from bladewright.section.curvature_meanline import CurvatureMeanline
from bladewright.section.thickness.modified_naca import ModifiedNaca

ROWS = 13
START, END = -60.0, 520.0
"""x of the flow path [mm]"""


def rows():
    """The designs, an inlet guide vane first."""
    return [_row(number) for number in range(ROWS)]


def _radii(x):
    """Hub and shroud radius [mm] of an annulus that narrows as the air grows denser."""
    along = (np.asarray(x) - START) / (END - START)
    return 150.0 + 45.0 * along**0.8, 260.0 - 30.0 * along


def _row(number):
    first, width = 36.0 * number, 30.0 - 0.9 * number
    x = np.array([START, first - 20.0, first, first + width, first + width + 20.0, END])
    hub, shroud = _radii(x)
    kind = "guide-vane" if number == 0 else ("stator", "rotor")[number % 2]
    inlet, outlet = {
        "guide-vane": ((0.0, 0.0, 0.0), (20.0, 16.0, 12.0)),
        "rotor": ((-44.0, -50.0, -56.0), (-14.0, -30.0, -42.0)),
        "stator": ((44.0, 40.0, 42.0), (6.0, 5.0, 8.0)),
    }[kind]
    return CurvatureMeanlineBlade(
        name=f"row-{number + 1:02d}-{kind}",
        description="One of thirteen rows of a compressor",
        length_unit="mm",
        blade_count=30 + 6 * number,
        flow_path=FlowPath(
            hub=ThroughPoints(points=tuple(zip(x, hub, strict=True))),
            shroud=ThroughPoints(points=tuple(zip(x, shroud, strict=True))),
        ),
        leading_edge=ThroughPoints(points=((first + 1.0, 140.0), (first - 1.0, 205.0), (first + 1.5, 275.0))),
        trailing_edge=ThroughPoints(
            points=((first + width, 140.0), (first + width - 1.0, 205.0), (first + 0.9 * width, 275.0))
        ),
        leading_edge_theta=(0.0, 0.6, -0.4),
        section=CurvatureMeanline(
            metal_angle_in=inlet,
            metal_angle_out=outlet,
            curvature=((0.3, 0.2, 0.1), (1.0, 0.7, 0.4), (0.9, 0.9, 0.9), (0.6, 0.8, 1.0), (0.2, 0.3, 0.4)),
            curvature_places=((0.20, 0.21, 0.22), (0.5, 0.5, 0.52), (0.8, 0.8, 0.81)),
            thickness=ModifiedNaca(
                leading_edge_index=(4.0, 4.1, 4.2),
                maximum_thickness=(0.085, 0.070, 0.055),
                maximum_thickness_at=(0.44, 0.45, 0.46),
                trailing_edge_thickness=(0.014, 0.012, 0.010),
                trailing_edge_slope=(-0.12, -0.11, -0.09),
            ),
            thickness_multiplier=((0.0, 0.0, 0.0), (0.02, 0.01, 0.0), (0.0, 0.01, 0.02), (0.0, 0.0, 0.0)),
        ),
    )
