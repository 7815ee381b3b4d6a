"""Machines whose laws are given by values at stations."""

from dataclasses import replace

import numpy as np

from bladewright.blade.design.families import (
    CamberAngleBlade,
    CurvatureMeanlineBlade,
    ProfileBlade,
    SuctionPressureBlade,
    WedgeDiffuserBlade,
)
from bladewright.blade.design.flow_path import Channel, FlowPath
from bladewright.designs import Stations
from bladewright.section.camber_angle import CamberAngle
from bladewright.section.laws import Span, named_laws
from bladewright.section.profiles.naca4 import Naca4
from bladewright.section.thickness.wennerstrom import Wennerstrom
from bladewright.section.wedge_diffuser import WedgeDiffuser

from . import COARSE, sectioned, unified
from .sectioned import through

SPAN = (0.0, 0.2, 0.45, 0.7, 1.0)


def at_stations(design, interpolation="natural", span=SPAN):
    """The design with each law along the span given by its own values at stations."""
    values = {path: Span(np.array(span)).values(law).tolist() for path, law in named_laws(design)}
    laws = {path: Stations(span=span, values=tuple(each), interpolation=interpolation) for path, each in values.items()}
    return design.changed(laws)


def moved(law, change):
    """The same stations with other values."""
    return replace(law, values=tuple(change(value) for value in law.values))


TABLE = Stations(span=(0.0, 0.25, 0.5, 0.75, 1.0), values=(-8.0, -22.0, -34.0, -42.0, -48.0))
"""An outlet metal angle as it stands in a table of stations [deg]."""
_AXIAL = {
    "length_unit": "mm",
    "blade_count": 12,
    "flow_path": FlowPath(hub=through((-60, 100), (100, 100)), shroud=through((-60, 160), (100, 160))),
    "leading_edge": through((0, 90), (0, 170)),
    "trailing_edge": through((40, 90), (40, 170)),
    "tolerance": COARSE,
}
AXIAL = {
    "unified": replace(
        unified.FAN,
        tolerance=COARSE,
        leading_edge_theta=0.0,
        stagger=moved(TABLE, lambda out: 0.5 * (20.0 + out)),
        metal_angle_in=20.0,
        metal_angle_out=TABLE,
        channel=Channel(leading_edge=((0, 100), (0, 160)), trailing_edge=((40, 100), (40, 160))),
    ),
    "curvature-meanline": CurvatureMeanlineBlade(
        **_AXIAL,
        name="turned",
        section=replace(
            sectioned.COMPRESSOR.section,
            metal_angle_in=20.0,
            metal_angle_out=TABLE,
            thickness=Wennerstrom(
                maximum_thickness=0.08,
                maximum_thickness_at=0.45,
                leading_edge_thickness=0.02,
                trailing_edge_thickness=0.02,
            ),
        ),
    ),
    "suction-pressure": SuctionPressureBlade(
        **_AXIAL,
        name="turned",
        section=replace(
            sectioned.STATOR.section,
            stagger_angle=moved(TABLE, lambda out: 20.0 + out),
            metal_angle_in=moved(TABLE, lambda out: 40.0 + out),
            metal_angle_out=TABLE,
        ),
    ),
    "camber-angle": CamberAngleBlade(
        **_AXIAL,
        name="turned",
        section=CamberAngle(camber_angle=(20.0, 0.0, TABLE), half_thickness=(0.012, 0.03, 0.02, 0.01)),
    ),
    "profile": ProfileBlade(**_AXIAL, name="turned", section=Naca4(thickness=0.1, stagger_angle=TABLE)),
    "wedge-diffuser": WedgeDiffuserBlade(
        **_AXIAL,
        name="turned",
        section=WedgeDiffuser(
            stagger_angle=TABLE, leading_edge_radius=0.01, trailing_edge_radius=0.02, wedge_angle=5.0
        ),
    ),
}
"""A blade of each family between cylinders, its outlet metal angle, or its stagger, as in that table."""
