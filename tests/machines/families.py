"""One design of each family that files can hold, by the family's name, in a flow path without joints."""

from dataclasses import replace

from bladewright.blade.design.flow_path import FlowPath
from bladewright.section.profiles.naca4 import Naca4

from . import sectioned
from .sectioned import through
from .sections import EXAMPLES
from .unified import INFLOW, VANE

CONES = {
    "flow_path": FlowPath(hub=through((-60, 90), (120, 110)), shroud=through((-60, 170), (120, 160))),
    "leading_edge": through((0, 80), (4, 180)),
    "trailing_edge": through((38, 80), (32, 180)),
}
"""straight walls and edges: what converges there is the interpolation alone"""
FAMILIES = {
    "unified": INFLOW,
    "unified-section": VANE,
    "curvature-meanline-section": EXAMPLES["curvature meanline of a compressor"].design,
    "suction-pressure-section": EXAMPLES["suction and pressure side of a stator"].design,
    "wedge-diffuser-section": EXAMPLES["wedge diffuser with a back face"].design,
    "camber-angle-section": EXAMPLES["camber-angle"].design,
    "profile-section": EXAMPLES["naca-2412"].design,
    "segmented-section": EXAMPLES["segmented"].design,
    "curvature-meanline": replace(sectioned.COMPRESSOR, **CONES),
    "suction-pressure": replace(sectioned.STATOR, **CONES),
    "wedge-diffuser": sectioned.DIFFUSER,
    "camber-angle": replace(sectioned.IMPELLER, **CONES),
    "profile": replace(sectioned.VANE, section=Naca4(thickness=(0.1, 0.08), stagger_angle=(30.0, 35.0))),
    "segmented": sectioned.MORPHING,
}
