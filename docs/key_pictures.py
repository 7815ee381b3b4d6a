"""What a key does to a section: the mid-span section of an example, and the same with one key raised and lowered."""

import tomllib
from dataclasses import fields

import numpy as np
from matplotlib.figure import Figure

from bladewright.designs import Part
from bladewright.errors import BladewrightError
from bladewright.files.examples import example_text
from bladewright.files.reading import design_from

SHOWN_IN = {
    "unified": "fan-rotor",
    "curvature-meanline": "core-rotor",
    "suction-pressure": "booster-stator",
    "wedge-diffuser": "exhaust-strut",
    "camber-angle": "backswept-impeller",
    "profile": "inlet-guide-vane",
    "unified-section": "turbine-section",
}
"""the example whose section shows what the keys of a family do"""
ANGLE = 6.0
"""by how much an angle is raised and lowered [deg]"""
SHARE = 0.25
"""by how much any other number is raised and lowered, of its value"""
COLOURS = {"raised": "tab:red", "lowered": "tab:blue"}


OTHER_KINDS = {
    "curvature-meanline": (
        {
            "law": "wennerstrom",
            "maximum_thickness": 0.08,
            "maximum_thickness_at": 0.45,
            "leading_edge_thickness": 0.012,
            "trailing_edge_thickness": 0.01,
        },
        {
            "law": "quartic-spline",
            "maximum_thickness": 0.08,
            "maximum_thickness_at": 0.3,
            "leading_edge_thickness": 0.02,
            "trailing_edge_thickness": 0.01,
        },
    ),
    "profile": (
        {"kind": "naca-4", "thickness": 0.12, "camber": 0.05, "camber_position": 0.4},
        {"kind": "naca-5", "thickness": 0.12},
        {"kind": "naca-6", "series": "64", "thickness": 0.12, "design_lift": 0.6},
        {"kind": "c4", "thickness": 0.1, "camber_angle": 25.0},
        {"kind": "double-circular-arc", "thickness": 0.08, "camber_angle": 25.0, "leading_edge_radius": 0.008},
        {
            "kind": "multiple-circular-arc",
            "thickness": 0.06,
            "camber_angle": 15.0,
            "transition": 0.5,
            "front_camber": 0.3,
            "leading_edge_radius": 0.006,
        },
        {"kind": "flat-plate", "thickness": 0.05, "leading_edge": "elliptic", "leading_edge_ratio": 3.0},
    ),
}
"""the same example with another thickness law, or another profile, so that their keys have pictures too"""


def draw(family, directory):
    """Pictures of a family's keys: name of the file and what it shows, by title of the table and name of the key."""
    if family not in SHOWN_IN:
        return {}
    document = tomllib.loads(example_text(SHOWN_IN[family]))
    shown = [document]
    for kind in OTHER_KINDS.get(family, ()):
        section = {**document["section"], "thickness": kind} if "law" in kind else {**kind, "stagger_angle": 20.0}
        shown.append({**document, "section": section})
    drawn = {}
    for each in shown:
        drawn = {**_drawn(family, design_from(each, SHOWN_IN[family]), directory), **drawn}
    return drawn


def _drawn(family, design, directory):
    shape, drawn = _shape(design), {}
    for part, prefix in _parts(design):
        for each in fields(part):
            unit, value = each.metadata.get("unit"), getattr(part, each.name)
            if unit is None or value in (None, ()) or not _leaves(value):
                continue
            shapes = {}
            for word, sign in (("raised", 1.0), ("lowered", -1.0)):
                try:
                    shapes[word] = _shape(design.changed(f"{prefix}{each.name}", _moved(value, sign, unit)))
                except BladewrightError:
                    continue
            if any(np.ptp(other - shape) > 1e-6 * np.ptp(shape) for other in shapes.values()):
                title = type(part).__name__
                name = f"{family}-{title}-{each.name}.svg"
                _picture(shape, shapes).savefig(directory / name, bbox_inches="tight")
                said = f"{ANGLE:g} deg more and less" if unit == "deg" else f"{100 * SHARE:g} % more and less"
                said = (
                    said if len(shapes) == 2 else said.replace(" and less" if "raised" in shapes else "more and ", "")
                )
                drawn[title, each.name] = name, said
    return drawn


def _parts(design):
    """The design itself and the parts of its section, each with the path that leads to its fields."""
    waiting = [(design, "")]
    while waiting:
        part, prefix = waiting.pop(0)
        yield part, prefix
        for each in fields(part):
            value = getattr(part, each.name)
            if isinstance(value, Part) and each.name in ("section", "thickness", "leading_edge_spline"):
                waiting.append((value, f"{prefix}{each.name}."))


def _leaves(value):
    return isinstance(value, (int, float)) or (isinstance(value, tuple) and all(_leaves(each) for each in value))


def _moved(value, sign, unit):
    if isinstance(value, tuple):
        return tuple(_moved(each, sign, unit) for each in value)
    if unit == "deg":
        return value + sign * ANGLE
    return value * (1.0 + sign * SHARE) if value else sign * SHARE


def _shape(design):
    """Points (k, 2) around the section at mid-span, in chords from the leading edge."""
    section = design.build() if design.dimension == 2 else design.exact_blade().section(0.5)
    u = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, 81))
    upper, lower = (np.real(section.curves[name](u)) for name in ("upper", "lower"))
    outline = np.concatenate([upper, lower[::-1]])
    return (outline - upper[0]) / np.hypot(*(upper[-1] - upper[0]))


def _picture(shape, shapes):
    figure = Figure(figsize=(4.2, 1.8))
    axes = figure.add_subplot()
    for word, other in shapes.items():
        axes.plot(*other.T, color=COLOURS[word], linewidth=0.8)
    axes.plot(*shape.T, color="black", linewidth=1.0)
    axes.set_aspect("equal")
    axes.set_axis_off()
    return figure
