"""Blades of the unified family in flow paths of every kind of curve: axial, radial from a radial inlet, and mixed."""

from bladewright.blade.design.flow_path import Channel, FlowPath

from .flow_paths import cornered, on, through
from .unified import FAN, IMPELLER, INFLOW

FAN_IN_PATH = FAN.changed(
    {
        "name": "fan-in-path",
        "flow_path": FlowPath(
            hub=through((-80.0, 90.0), (-30.0, 91.0), (0.0, 96.0), (45.0, 109.0), (89.0, 117.0), (150.0, 118.0)),
            shroud=through((-80.0, 258.0), (0.0, 255.5), (45.0, 252.0), (80.0, 248.5), (150.0, 247.0)),
        ),
        "channel": Channel(
            leading_edge=((-1.0, 92.0), (6.0, 152.0), (17.0, 204.0), (23.0, 258.0)),
            trailing_edge=((89.0, 114.0), (78.0, 201.0), (65.0, 250.0)),
        ),
    }
)
"""its edges are drawn past the walls"""
IMPELLER_IN_PATH = IMPELLER.changed(
    {
        "name": "impeller-in-path",
        "flow_path": FlowPath(
            hub=on((-30.0, 16.0), (-10.0, 16.0), (10.0, 16.0), (36.0, 22.0), (38.0, 45.0), (38.0, 70.0), (38.0, 95.0)),
            shroud=on((-30.0, 42.0), (-5.0, 42.0), (12.0, 42.0), (31.0, 46.0), (32.0, 62.0), (32.0, 75.0), (32.0, 95)),
        ),
        "channel": Channel(leading_edge=((0.0, 16.5), (0.0, 41.5)), trailing_edge=((37.9, 70.0), (32.1, 70.0))),
    }
)
"""its hub is flat upstream, its diffuser radial, and its edges are drawn short of the walls"""
INFLOW_IN_PATH = INFLOW.changed(
    {
        "name": "inflow-in-path",
        "flow_path": FlowPath(
            hub=cornered((0.0, 80.0), (0.0, 14.5), (75.0, 14.5), radii=(50.0,)),
            shroud=cornered((6.5, 80.0), (6.5, 36.8), (75.0, 36.8), radii=(32.0,)),
        ),
        "channel": Channel(leading_edge=((0.0, 59.0), (8.5, 59.0)), trailing_edge=((39.0, 15.0), (35.0, 37.5))),
    }
)
"""a purely radial inlet, arcs, and a flat hub behind; its edges are drawn past one wall and short of the other"""
DESIGNS = {design.name: design for design in (FAN_IN_PATH, IMPELLER_IN_PATH, INFLOW_IN_PATH)}
