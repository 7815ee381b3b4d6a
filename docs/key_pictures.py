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


def draw(family, directory):
    """Pictures of a family's keys: name of the file and what it shows, by title of the table and name of the key."""
    if family not in SHOWN_IN:
        return {}
    design = design_from(tomllib.loads(example_text(SHOWN_IN[family])), SHOWN_IN[family])
    shape = _shape(design)
    drawn = {}
    for part, prefix in _parts(design):
        for each in fields(part):
            unit = each.metadata.get("unit")
            value = getattr(part, each.name)
            if unit is None or value in (None, ()) or not _leaves(value):
                continue
            shapes = {}
            for word, sign in (("raised", 1.0), ("lowered", -1.0)):
                changed = _moved(value, sign, unit)
                try:
                    shapes[word] = _shape(design.changed(f"{prefix}{each.name}", changed))
                except BladewrightError:
                    continue
            if any(np.ptp(other - shape) > 1e-6 * np.ptp(shape) for other in shapes.values()):
                name = f"{family}-{prefix}{each.name}.svg".replace("..", ".")
                _picture(shape, shapes).savefig(directory / name, bbox_inches="tight")
                said = f"{ANGLE:g} deg more and less" if unit == "deg" else f"{100 * SHARE:g} % more and less"
                drawn[type(part).__name__, each.name] = name, said
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
    return value + sign * ANGLE if unit == "deg" else value * (1.0 + sign * SHARE)


def _shape(design):
    """Points (k, 2) around the section at mid-span, in chords from the leading edge."""
    section = design.build() if design.dimension == 2 else design.exact_blade().section(0.5)
    u = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, 81))
    upper, lower = (np.real(section.curves[name](u)) for name in ("upper", "lower"))
    outline = np.concatenate([upper, lower[::-1]])
    if design.dimension == 2:
        return (outline - upper[0]) / np.hypot(*(upper[-1] - upper[0]))
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
