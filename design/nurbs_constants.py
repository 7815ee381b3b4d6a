"""What the constants of `numerics/` and `nurbs/` decide: error and time with each constant smaller and larger.

python design/nurbs_constants.py --record design/nurbs_constants.md
"""

import argparse
import importlib
import inspect
import sys
import time
from contextlib import contextmanager
from importlib import resources
from pathlib import Path

import numpy as np

import bladewright as bw
from bladewright.nurbs.closest import Descents, closest_on_curve, closest_on_surface
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.fit import interpolated
from bladewright.nurbs.measure import arc_length, area
from bladewright.nurbs.revolution import arc, revolved, segment
from bladewright.nurbs.skinning import ruled

POINTS = 3000
"""points whose closest ones are sought, within a tenth of the chord of the side"""
HEAD = """\
# Constants of quadrature and closest points

`{command}`: error and processor time, beside other work, with one constant changed at a time.

* trimmed area: of both ends of Rotor 67, by `converged_quadrature`; relative error;
* near-cusp: the length of a cubic that turns within 1e-6 of its length, by `adaptive`; relative error;
* pinched area: a side of Rotor 67 whose knots along u gather at the leading edge, by `area`; relative error;
* closest: {points} points about a side of Rotor 67 and its hub section each; largest excess of a distance, in chords;
* on axes: distances from an interpolated cylinder of radius 1 to points on its axis, and from a cone to points 2e-8 off
  it; largest excess;
* descents: largest distance of 8,000 points of an impeller's sides from these, found without a start [m];
* normal: at the pole of a sphere, largest error;
* rebuild: Rotor 67 at held knots.

| constant | value | figure | error | ms |
|---|---|---|---|---|
"""


@contextmanager
def changed(module, name, value):
    """A constant with another value, also where it is the default of an argument in its module."""
    own, undo = getattr(module, name), []
    for function in {each for _, each in inspect.getmembers(module, inspect.isfunction)}:
        undo.append((function, function.__defaults__, function.__kwdefaults__))
        function.__defaults__ = swapped(function.__defaults__, own, value)
        keywords = function.__kwdefaults__
        function.__kwdefaults__ = keywords and {key: value if each == own else each for key, each in keywords.items()}
    setattr(module, name, value)
    try:
        yield
    finally:
        setattr(module, name, own)
        for function, defaults, keywords in undo:
            function.__defaults__, function.__kwdefaults__ = defaults, keywords


def swapped(defaults, own, value):
    """Defaults with a value in the place of another."""
    return defaults and tuple(value if each == own else each for each in defaults)


def blade():
    """Rotor 67."""
    return bw.read_design(resources.files("bladewright") / "examples" / "nasa-rotor-67.toml").build()


def trimmed_area(made):
    """Areas of both ends."""
    return np.array([made.surfaces[name].area() for name in made.design.ends])


def near_cusp(_):
    """Length of a plane cubic that almost stops and turns back."""
    points = np.array([[0.0, 0.0], [1.0, 1.0 + 1e-6], [0.0, 1.0], [1.0, 0.0]])
    return np.array([arc_length(Curve(control_points=points, knots=np.repeat([0.0, 1.0], 4), degree=3), 0.0, 0.9)])


def pinched_area(made):
    """Area of a side whose control points gather towards the leading edge."""
    side = made.sides[0]
    knots = side.knots_u**3
    return np.array([area(type(side)(**{**fields_of(side), "knots_u": knots}))])


def fields_of(side):
    """The fields of a surface."""
    names = ("control_points", "knots_u", "knots_v", "degree_u", "degree_v", "weights")
    return {name: getattr(side, name) for name in names}


def closest(made):
    """Distances of points about a side, and about a section."""
    side, random = made.sides[0], np.random.default_rng(7)
    near = side(random.random(POINTS), random.random(POINTS)) + 0.1 * made.chord * random.normal(size=(POINTS, 3))
    section = Curve(control_points=side.control_points[:, 0], knots=side.knots_u, degree=side.degree_u)
    return np.concatenate([closest_on_surface(side, near).distances, closest_on_curve(section, near).distances])


def on_axes(_):
    """Distances from a ruled surface between two interpolated arcs to points on its axis, and just off a cone."""
    angle = np.linspace(0.0, 1.5, 50) ** 3 / 1.5**2
    arcs = [np.stack([np.cos(angle), np.sin(angle), np.full(50, z)], axis=-1) for z in (0.0, 2.0)]
    bent = ruled(*(interpolated(each, angle / 1.5, degree=5) for each in arcs))
    cone, (u, v) = revolved(segment((0.0, 1.0, 0.0), (1.0, 2.0, 0.0))), np.random.default_rng(1).random((2, 44))
    middle = np.stack([np.zeros(44), np.zeros(44), np.linspace(0.1, 1.9, 44)], axis=-1)
    beside = cone(u, v) + 2e-8 * cone.normal(u, v)
    found = [closest_on_surface(*each, tolerance=1e-9) for each in ((bent, middle), (cone, beside))]
    return np.concatenate([each.distances for each in found])


def descents(_):
    """Distances of points of both sides of an impeller with thin edges, which are 0."""
    sides = bw.read_design(resources.files("bladewright") / "examples" / "backswept-impeller.toml").build().sides
    u, v = np.random.default_rng(0).random((2, 4000))
    points = np.concatenate([side(u, v) for side in sides])
    return np.sqrt(Descents(tuple(sides)).nearest(points).square)


def normal(_):
    """Normals of a sphere about its pole."""
    circle = arc((0.0, 0.0), 1.0, 0.0, np.pi)
    net = np.column_stack([circle.control_points, np.zeros(len(circle.control_points))])
    sphere = revolved(Curve(control_points=net, knots=circle.knots, degree=2, weights=circle.weights))
    u = np.concatenate([[0.0], 10.0 ** np.linspace(-14.0, -2.0, 49)])
    v = np.full(len(u), 0.3)
    return sphere.normal(u, v) - sphere(u, v) * np.sign(np.sum(sphere.normal(u, v) * sphere(u, v), axis=-1))[:, None]


def rebuild(made):
    """Volume of a build at held knots."""
    return np.array([made.design.build(knots=made.knots).properties.volume])


QUADRATURE = "numerics.quadrature"
CONSTANTS = (
    (QUADRATURE, "FIRST_ORDER", trimmed_area, (6, 24)),
    (QUADRATURE, "LAST_ORDER", trimmed_area, (36, 144)),
    (QUADRATURE, "ORDER_GROWTH", trimmed_area, (1.3, 2.5)),
    (QUADRATURE, "TOLERANCE", trimmed_area, (1e-10, 1e-15)),
    (QUADRATURE, "ADAPTIVE_ORDER", near_cusp, (8, 32)),
    (QUADRATURE, "ADAPTIVE_TOLERANCE", near_cusp, (1e-11, 1e-16)),
    (QUADRATURE, "MAX_HALVINGS", near_cusp, (10, 80)),
    ("nurbs.measure", "PER_PATCH", pinched_area, (4, 9)),
    ("nurbs.measure", "ROUNDING", pinched_area, (1e-10, 1e-15)),
    ("nurbs.measure", "MAX_QUARTERINGS", pinched_area, (4, 48)),
    ("nurbs.measure", "MAX_PATCHES", pinched_area, (2_000, 200_000)),
    ("nurbs.closest", "TOLERANCE", closest, (1e-6, 1e-12)),
    ("nurbs.descent", "MAX_STEPS", closest, (20, 800)),
    ("nurbs.descent", "CONVERGED", closest, (1e-8, 1e-15)),
    ("nurbs.descent", "LEAST_GAIN", closest, (0.0, 1e-14)),
    ("nurbs.descent", "NOISE", closest, (0.0, 1e-10)),
    ("nurbs.descent", "SINGULAR", closest, (0.0, 1e-6)),
    ("nurbs.proximity", "BLOCK", closest, (200_000, 20_000_000)),
    ("nurbs.proximity", "MAX_HALVINGS", closest, (12, 96)),
    ("nurbs.proximity", "VALLEY_STEPS", on_axes, (1, 8)),
    ("nurbs.proximity", "ROUNDING", on_axes, (1e-14, 1e-12)),
    ("nurbs.proximity", "MANY_BOXES", on_axes, (200, 2_000_000)),
    ("nurbs.closest", "OTHER_SHAPE_RATIO", descents, (1.0, 2.0)),
    ("nurbs.closest", "JOINT_BAND", descents, (0.0, 0.1)),
    ("nurbs.surface", "COLLAPSED", normal, (1e-14, 1e-5)),
    ("nurbs.basis", "MAX_CACHED", rebuild, (0, 100_000)),
)


def timed(measure, made):
    """Value, and the best of three times [ms]."""
    times = []
    for _ in range(3):
        start = time.process_time()
        value = measure(made)
        times.append(time.process_time() - start)
    return value, 1e3 * min(times)


def error(measure, made, value, best):
    """How far a value is off the reference: relative, in chords for distances, absolute for normals."""
    if measure in (normal, descents):
        return float(np.max(np.abs(value)))
    scale = made.chord if measure is closest else 1.0 if measure is on_axes else np.abs(best)
    return float(np.max(np.abs(value - best) / scale))


def rows(made):
    """The table's rows, each printed as soon as it is known."""
    with (
        changed(importlib.import_module("bladewright.numerics.quadrature"), "TOLERANCE", 0.0),
        changed(importlib.import_module("bladewright.numerics.quadrature"), "LAST_ORDER", 160),
        changed(importlib.import_module("bladewright.numerics.quadrature"), "ADAPTIVE_ORDER", 40),
        changed(importlib.import_module("bladewright.nurbs.measure"), "PER_PATCH", 12),
        changed(importlib.import_module("bladewright.nurbs.closest"), "TOLERANCE", 1e-14),
    ):
        best = {each: each(made) for each in dict.fromkeys(each for _, _, each, _ in CONSTANTS)}
    for measure, reference in best.items():
        value, milliseconds = timed(measure, made)
        off = error(measure, made, value, reference)
        yield f"| as they are | | {named(measure)} | {off:.1e} | {milliseconds:.1f} |"
    for path, name, measure, values in CONSTANTS:
        module = importlib.import_module(f"bladewright.{path}")
        own = getattr(module, name)
        for each in values:
            with changed(module, name, each):
                value, milliseconds = timed(measure, made)
            off = error(measure, made, value, best[measure])
            yield f"| `{path}.{name}` = {own:g} | {each:g} | {named(measure)} | {off:.1e} | {milliseconds:.1f} |"


def named(measure):
    """The figure's name in the table."""
    return measure.__name__.replace("_", " ")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--record", type=Path, help="write the table to this file")
    given = parser.parse_args()
    found = []
    for row in rows(blade()):
        print(row, flush=True)
        found.append(row)
    if given.record:
        head = HEAD.format(command=f"python design/nurbs_constants.py --record {given.record}", points=POINTS)
        given.record.write_text(head + "\n".join(found) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
