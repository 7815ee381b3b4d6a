"""A blade from sections drawn at random, of any family and in any machine: the more `wild`, the less can be built."""

import numpy as np
from random_blades import law, pairs

from bladewright.blade.design.families import (
    CamberAngleBlade,
    CurvatureMeanlineBlade,
    ProfileBlade,
    SuctionPressureBlade,
    WedgeDiffuserBlade,
)
from bladewright.blade.design.flow_path import FlowPath
from bladewright.blade.design.meridional_curve import ControlPolygon, ThroughPoints
from bladewright.blade.design.stacking import Stacking
from bladewright.section.camber_angle import CamberAngle
from bladewright.section.checks import UNITS
from bladewright.section.curvature_meanline import CurvatureMeanline
from bladewright.section.profiles.c4 import C4
from bladewright.section.profiles.circular_arc import DoubleCircularArc
from bladewright.section.profiles.naca4 import Naca4
from bladewright.section.profiles.naca65 import Naca65
from bladewright.section.suction_pressure.part import SuctionPressure
from bladewright.section.thickness.modified_naca import ModifiedNaca
from bladewright.section.thickness.wennerstrom import Wennerstrom
from bladewright.section.wedge_diffuser import WedgeDiffuser

REACH = 0.9
"""lengths of the blade by which the flow path reaches past it at both ends"""


def random_design(seed):
    """The design of a seed; raises DesignError where its numbers alone are refused."""
    draw = np.random.default_rng([seed, 2])
    unit = str(draw.choice(["mm", "mm", "m", "in"]))
    wild = draw.random()
    family = str(draw.choice(list(FAMILIES)))
    shape = random_shape(seed)
    linear = shape == "linear"
    path, edges, length, radius = _machine(draw, shape, wild, 0.1 / UNITS[unit])
    stagger = draw.uniform(-65.0, 65.0)
    turn = draw.uniform(-1.0, 1.0) * (15.0 + 45.0 * wild)
    kind, section = FAMILIES[family]
    solidity = np.exp(draw.uniform(np.log(0.3), np.log(2.5))) * np.cos(np.radians(stagger))
    count = int(np.clip(round(2.0 * np.pi * radius / length * solidity), 1, 200))
    placing = edges
    if draw.random() < 0.3:
        placing = {
            "stacking": Stacking(
                reference=str(draw.choice(["leading-edge", "trailing-edge", "centroid"])),
                chord=law(draw, length / np.cos(np.radians(stagger)), 0.2 * wild * length, (0.01 * length, 9e9)),
                line=ThroughPoints(points=_middle(edges)),
            )
        }
    shifts = {}
    if draw.random() < 0.3:
        shifts = {name: law(draw, 0.0, 0.1 * wild * length, 9e9) for name in ("sweep", "lean")}
        shifts["shift_directions"] = str(draw.choice(["meridional-tangential", "chordwise-normal"]))
    return kind(
        name=f"random-{seed}",
        description=f"{shape}, {family}, seed {seed}",
        length_unit=unit,
        arrangement="linear" if linear else "annular",
        **({"pitch": length / solidity} if linear else {"blade_count": count}),
        plane=str(draw.choice(["m'-theta", "m'-theta", "m-r*theta"])),
        flow_path=path,
        **placing,
        **shifts,
        skinning="ruled" if draw.random() < 0.05 else "sections",
        section=section(draw, wild, stagger, turn),
    )


def random_shape(seed):
    """The kind of machine of a seed."""
    kinds = ["axial", "axial", "radial outward", "radial inward", "mixed", "linear"]
    return str(np.random.default_rng([seed, 3]).choice(kinds))


def _machine(draw, shape, wild, size):
    """A flow path around a bent mean line, edge curves across it, the blade's length and its mean radius."""
    start, end = {
        "linear": draw.uniform(-10.0, 10.0, 2),
        "axial": draw.uniform(-20.0, 20.0, 2),
        "radial outward": (draw.uniform(-10.0, 80.0), draw.uniform(75.0, 95.0)),
        "radial inward": (draw.uniform(-95.0, -75.0), draw.uniform(-80.0, 10.0)),
        "mixed": draw.uniform(15.0, 60.0, 2),
    }[shape]
    length = size * np.exp(draw.uniform(np.log(0.1), np.log(5.0)))
    span = length * np.exp(draw.uniform(np.log(0.2), np.log(2.0)))
    t = np.linspace(-REACH, 1.0 + REACH, 141)
    phi = np.radians(start + (end - start) * np.clip(t, 0.0, 1.0))
    step = length * (t[1] - t[0]) * np.stack([np.cos(phi), np.sin(phi)], axis=-1)
    middle = np.concatenate([[[0.0, 0.0]], np.cumsum((step[1:] + step[:-1]) / 2.0, axis=0)])
    normal = np.stack([-np.sin(phi), np.cos(phi)], axis=-1)
    width = span * np.linspace(1.0, draw.uniform(0.5, 1.2), len(t))[:, None]
    walls = [middle + sign * width / 2.0 * normal for sign in (-1.0, 1.0)]
    lowest = min(float(np.min(wall[:, 1])) for wall in walls)
    clearance = (span + length) * np.exp(draw.uniform(np.log(0.2), np.log(4.0)))
    lift = np.array([0.0, clearance - lowest])
    noise = 0.03 * length * wild**2
    places = np.linspace(0, 140, int(draw.integers(4, 8))).round().astype(int)
    hub, shroud = (
        ThroughPoints(points=pairs((wall + lift)[places] + noise * draw.normal(size=(len(places), 2))))
        for wall in walls
    )
    edges = {}
    for name, at in (("leading_edge", np.argmin(t**2)), ("trailing_edge", np.argmin((t - 1.0) ** 2))):
        across = walls[1][at] - walls[0][at]
        share = np.linspace(-0.1, 1.1, int(draw.integers(2, 5)))[:, None]
        points = walls[0][at] + share * across + lift + noise * draw.normal(size=(len(share), 2))
        kind = (
            ThroughPoints(points=pairs(points)) if draw.random() < 0.5 else ControlPolygon(control_points=pairs(points))
        )
        edges[name] = kind
    return FlowPath(hub=hub, shroud=shroud), edges, float(length), float(np.mean(middle[:, 1]) + lift[1])


def _middle(edges):
    """A line half way between both edges' first and last points."""
    ends = [edge.points if isinstance(edge, ThroughPoints) else edge.control_points for edge in edges.values()]
    return pairs([[(a.x + b.x) / 2.0, (a.r + b.r) / 2.0] for a, b in ((ends[0][i], ends[1][i]) for i in (0, -1))])


def _curvature_meanline(draw, wild, stagger, turn):
    spread = 2.0 + 10.0 * wild
    thick = float(np.exp(draw.uniform(np.log(0.03), np.log(0.15))))
    edge = thick * draw.uniform(0.1, 0.4)
    end = str(draw.choice(["elliptic", "blunt", "sharp"]))
    laws = (
        ModifiedNaca(
            leading_edge_index=draw.uniform(2.0, 7.0),
            maximum_thickness=law(draw, thick, 0.2 * thick, (0.01, 0.3)),
            maximum_thickness_at=draw.uniform(0.3, 0.55),
            trailing_edge_thickness=edge,
            trailing_edge_slope=-thick * draw.uniform(0.8, 1.8),
        ),
        Wennerstrom(
            maximum_thickness=law(draw, thick, 0.2 * thick, (0.01, 0.3)),
            maximum_thickness_at=draw.uniform(0.35, 0.6),
            leading_edge_thickness=edge,
            trailing_edge=end,
            **({} if end == "sharp" else {"trailing_edge_thickness": edge}),
        ),
    )
    thickness = laws[int(draw.integers(2))]
    return CurvatureMeanline(
        metal_angle_in=law(draw, stagger + turn / 2.0, spread, 80.0),
        metal_angle_out=law(draw, stagger - turn / 2.0, spread, 80.0),
        curvature=tuple(law(draw, draw.uniform(-0.1, 1.0), 0.2 * wild, 9.0) for _ in range(draw.integers(2, 7))),
        thickness=thickness,
    )


def _suction_pressure(draw, wild, stagger, turn):
    thick = draw.uniform(0.05, 0.12)
    camber = np.radians(turn) / 8.0
    shape = np.sin(np.pi * np.array([0.3, 0.5, 0.7]))
    bend = 1.0 if turn >= 0.0 else -1.0
    rise, fall = (
        tuple(law(draw, bend * camber * s + side * thick * s, 0.02 * wild, 1.0) for s in shape) for side in (0.6, -0.6)
    )
    radius = thick * draw.uniform(0.05, 0.15)
    return SuctionPressure(
        stagger_angle=law(draw, stagger, 5.0 * wild, 80.0),
        metal_angle_in=law(draw, stagger + turn / 2.0, 5.0 * wild, 85.0),
        metal_angle_out=law(draw, stagger - turn / 2.0, 5.0 * wild, 85.0),
        leading_edge_radius=radius,
        leading_edge_stretch=draw.uniform(1.0, 3.0),
        leading_edge_wedge=draw.uniform(5.0, 20.0),
        trailing_edge_radius=radius,
        trailing_edge_wedge=draw.uniform(3.0, 15.0),
        suction_side="upper" if bend > 0.0 else "lower",
        suction_tangent_in=draw.uniform(0.05, 0.15),
        suction_tangent_out=draw.uniform(0.05, 0.15),
        suction_heights=rise,
        pressure_heights=fall,
        edges=str(draw.choice(["C1", "C2"])),
    )


def _camber_angle(draw, wild, stagger, turn):
    angles = np.linspace(stagger + turn / 2.0, stagger - turn / 2.0, int(draw.integers(2, 6)))
    thick = draw.uniform(0.01, 0.05)
    count = int(draw.integers(3, 6))
    bump = 0.4 + 0.6 * np.sin(np.pi * (np.arange(count) + 0.5) / count)
    return CamberAngle(
        camber_angle=tuple(law(draw, float(each), 2.0 + 8.0 * wild, 80.0) for each in angles),
        half_thickness=tuple(law(draw, thick * float(each), 0.1 * thick, (1e-3, 0.3)) for each in bump),
        trailing_edge=str(draw.choice(["round", "blunt", "sharp"])),
    )


def _profile(draw, wild, stagger, turn):
    thick, angle = law(draw, draw.uniform(0.05, 0.15), 0.02, (0.02, 0.3)), law(draw, stagger, 2.0 + 8.0 * wild, 80.0)
    choice = int(draw.integers(4))
    if choice == 0:
        return Naca65(thickness=thick, lift_coefficient=law(draw, turn / 40.0, 0.2, 2.5), stagger_angle=angle)
    if choice == 1:
        camber = abs(turn) / 800.0
        return Naca4(thickness=thick, camber=law(draw, camber, 0.1 * camber, (0.0, 0.09)), stagger_angle=angle)
    if choice == 2:
        return C4(thickness=thick, camber_angle=law(draw, turn, 4.0, 100.0), stagger_angle=angle)
    return DoubleCircularArc(thickness=thick, camber_angle=law(draw, turn, 4.0, 100.0), stagger_angle=angle)


def _wedge(draw, wild, stagger, _turn):
    first, last = draw.uniform(0.003, 0.02), draw.uniform(0.005, 0.03)
    least = 2.0 * np.degrees(np.arcsin(max(last - first, 0.0) / (1.0 - first - last)))
    angle = None if draw.random() < 0.3 else float(least + draw.uniform(2.0, 10.0))
    return WedgeDiffuser(
        stagger_angle=law(draw, stagger, 3.0 * wild, 80.0),
        leading_edge_radius=first,
        trailing_edge_radius=last,
        wedge_angle=angle,
    )


FAMILIES = {
    "curvature-meanline": (CurvatureMeanlineBlade, _curvature_meanline),
    "suction-pressure": (SuctionPressureBlade, _suction_pressure),
    "camber-angle": (CamberAngleBlade, _camber_angle),
    "profile": (ProfileBlade, _profile),
    "wedge-diffuser": (WedgeDiffuserBlade, _wedge),
}
"""The families, their designs and what draws their sections."""
