"""Clouds of blades and sections that are of no family here: lines, arcs and published formulas, without bladewright.

    python design/foreign_blades.py [--directory DIR]

A section is a closed row of pieces, each a function of t in [0, 1] in metres, x along the chord from the leading edge.
A blade places one at every share of its span. Points are exact to rounding. The command draws every shape.
"""

import argparse
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.optimize import brentq

FINE = 4001
"""places of a piece from which its points are spaced by arc length"""
LEAST = 6
"""points of the shortest piece: meshes resolve an edge, however small"""


@dataclass(frozen=True, kw_only=True)
class Shape:
    """A section, or a blade of sections."""

    chord: float
    """[m], of a blade at mid-span"""
    pieces: Callable
    """the pieces (t -> (n, 2)) at a share of the span"""
    place: Callable | None = None
    """points (n, 2) at a share of the span, in space (n, 3); none: a section"""
    tip: bool = False
    """whether a face closes the tip, and is part of the cloud"""

    def points(self, draw, rows=21, along=160):
        """Points as a mesh has them: evenly spaced along the contour but for a third of the spacing, shuffled."""
        shares = np.linspace(0.0, 1.0, rows) if self.place else [0.0]
        found = np.concatenate([self._row(share, along if self.place else 500, draw) for share in shares])
        if self.tip:
            row = self.pieces(1.0)
            t, share = draw.random((2, 200))
            inside = row[0](t) + share[:, None] * (row[-1](1.0 - t) - row[0](t))
            found = np.concatenate([found, self.place(inside, 1.0)])
        return draw.permutation(found)

    def others(self, draw):
        """Other points, of the sides and edges alone."""
        shares = draw.random(64) if self.place else np.zeros(4)
        return np.concatenate([self._row(share, 125 if self.place else 1000, draw) for share in shares])

    def _row(self, share, count, draw):
        pieces = self.pieces(share)
        t = np.linspace(0.0, 1.0, FINE)
        lengths = [
            np.concatenate([[0.0], np.cumsum(np.sqrt(np.sum(np.diff(piece(t), axis=0) ** 2, axis=-1)))])
            for piece in pieces
        ]
        total, found = sum(length[-1] for length in lengths), []
        for piece, length in zip(pieces, lengths, strict=True):
            number = max(LEAST, round(count * length[-1] / total))
            at = (np.arange(number) + 0.5 + draw.uniform(-0.33, 0.33, number)) / number
            found.append(piece(np.interp(at * length[-1], length, t)))
        flat = np.concatenate(found)
        return self.place(flat, share) if self.place else flat


def line(start, end):
    """A straight piece."""
    return lambda t: (
        np.asarray(start) + np.asarray(t)[:, None] * (np.asarray(end, dtype=float) - np.asarray(start, dtype=float))
    )


def arc(centre, radius, first, last):
    """A piece of a circle between two polar angles [rad]."""
    return lambda t: (
        np.asarray(centre)
        + radius
        * np.stack([np.cos(first + np.asarray(t) * (last - first)), np.sin(first + t * (last - first))], axis=-1)
    )


def direction(angle):
    """The unit vector of a polar angle [rad]."""
    return np.array([np.cos(angle), np.sin(angle)])


def impulse(chord=0.04, angle=60.0, wedge=8.0, back=0.38, edge=0.0):
    """An impulse blade: arcs of two circles and two straight lines, symmetric, with sharp or round edges.

    The lower side is one arc that turns by twice `angle` [deg]; the upper side leaves its ends under the `wedge` [deg]
    on lines that are tangent to an arc of radius `back` chords. `edge` is the edges' radius [m].
    """
    beta, gamma = np.radians(angle), np.radians(angle + wedge)
    radius, back = 0.5 * chord / np.sin(beta), back * chord
    tip = radius * np.array([-np.sin(beta), np.cos(beta)])
    along, across = direction(gamma), np.array([-np.sin(gamma), np.cos(gamma)])
    middle = np.array([0.0, (tip @ across - back) / np.cos(gamma)])
    touch = middle + back * across
    if not edge:
        half = [line(tip, touch), arc(middle, back, gamma + np.pi / 2.0, np.pi / 2.0)]
        lower = arc((0.0, 0.0), radius, np.pi / 2.0, np.pi / 2.0 + beta)
        return closed([*half], lower, chord)
    # the circle touches the line from below and the lower arc from above
    start = tip - edge * across
    s = -(start @ along) - np.sqrt((start @ along) ** 2 - start @ start + (radius + edge) ** 2)
    s = s if s > 0.0 else -(start @ along) + np.sqrt((start @ along) ** 2 - start @ start + (radius + edge) ** 2)
    centre = start + s * along
    polar = np.arctan2(centre[1], centre[0])
    nose = arc(centre, edge, polar + np.pi, gamma + np.pi / 2.0)
    half = [nose, line(tip + s * along, touch), arc(middle, back, gamma + np.pi / 2.0, np.pi / 2.0)]
    return closed(half, arc((0.0, 0.0), radius, np.pi / 2.0, polar), chord)


def closed(half, lower, chord):
    """The shape of the left half of a symmetric section, from its edge over its top, and below back to the edge."""

    def moved(piece, sign):
        return lambda t: piece(t) * (sign, 1.0) + (0.5 * chord, 0.0)

    pieces = [moved(piece, sign) for piece in (*half, lower) for sign in (1.0, -1.0)]
    return Shape(chord=chord, pieces=lambda _: pieces)


def nozzle(pitch=0.04, turn=68.0, nose=0.01, throat=0.0095, edge=0.0005, radius=0.035):
    """A vane of a supersonic nozzle row: what two neighbouring converging-diverging channels leave between them.

    A channel's middle line is axial, turns on an arc, and runs on straight; its width falls to the throat and grows to
    the exit, and is constant beyond, so that the vane ends with parallel sides and a round edge.
    """
    angle = np.radians(turn)
    bend, exit_width = radius * angle, pitch * np.cos(angle) - edge
    narrowest, widest, end = bend + 0.006, bend + 0.036, bend + 0.036
    last = end + pitch * np.sin(angle)

    def middle(s):
        phi = np.minimum(s / radius, angle)
        rest = np.maximum(s - bend, 0.0)
        return np.stack([radius * np.sin(phi), radius * (1.0 - np.cos(phi))], axis=-1) + rest[:, None] * direction(
            angle
        )

    def normal(s):
        phi = np.minimum(s / radius, angle)
        return np.stack([-np.sin(phi), np.cos(phi)], axis=-1)

    def step(x):
        x = np.clip(x, 0.0, 1.0)
        return x**3 * (10.0 - 15.0 * x + 6.0 * x**2)

    def half_width(s):
        entry = pitch - nose
        fall = entry + (throat - entry) * step(s / narrowest)
        return 0.5 * (fall + (exit_width - throat) * step((s - narrowest) / (widest - narrowest)))

    def upper(t):
        s = t * end
        return middle(s) - half_width(s)[:, None] * normal(s)

    def lower(t):
        s = t * last
        return middle(s) - (0.0, pitch) + half_width(s)[:, None] * normal(s)

    one = np.ones(1)
    back = 0.5 * (upper(one) + lower(one))[0]
    front = 0.5 * (upper(0.0 * one) + lower(0.0 * one))[0]
    pieces = [
        arc(front, nose / 2.0, 1.5 * np.pi, 0.5 * np.pi),
        upper,
        arc(back, edge / 2.0, angle + np.pi / 2.0, angle - np.pi / 2.0),
        lower,
    ]
    chord = float(np.sqrt(np.sum((back - front) ** 2))) + nose / 2.0 + edge / 2.0
    return Shape(chord=chord, pieces=lambda _: pieces)


def naca(chord=0.08, thickness=0.12, camber=0.04, place=0.4, edge="sharp", back=0.0):
    """Pieces of a NACA four-digit section (Abbott and von Doenhoff 1959) whose trailing edge is closed.

    The edge is sharp, blunt with a thickness `back` [m], or round: a circle that touches the thickness of such a blunt
    one on both sides and ends at the chord's end.
    """

    def half(x):
        series = 0.2969 * np.sqrt(x) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4
        return 5.0 * thickness * series + 0.5 * back / chord * x

    def slope(x):
        series = 0.14845 / np.sqrt(x) - 0.126 - 0.7032 * x + 0.8529 * x**2 - 0.4144 * x**3
        return 5.0 * thickness * series + 0.5 * back / chord

    def on(x, y):
        front = x < place
        share = np.where(front, place, 1.0 - place) ** 2
        rise = camber / share * np.where(front, 2.0 * place * x - x**2, 1.0 - 2.0 * place + 2.0 * place * x - x**2)
        angle = np.arctan(2.0 * camber / share * (place - x))
        return chord * np.stack([x - y * np.sin(angle), rise + y * np.cos(angle)], axis=-1)

    def side(sign, last, *, backwards):
        def piece(t):
            t = 1.0 - t if backwards else t
            x = last * (1.0 - np.cos(np.pi * t)) / 2.0
            return on(x, sign * half(x))

        return piece

    last = 1.0
    ends = []
    if edge == "blunt":
        ends = [line(on(1.0, half(1.0)), on(1.0, -half(1.0)))]
    if edge == "round":

        def radius(x):
            return half(x) * np.sqrt(1.0 + slope(x) ** 2)

        def tip(x):
            return x + half(x) * slope(x) + radius(x)

        last = brentq(lambda x: tip(x) - 1.0, 0.9, 0.99999)
        middle, size = last + half(last) * slope(last), radius(last)
        first = np.arccos((last - middle) / size)

        def ends_of(t):
            angle = first * (1.0 - 2.0 * t)
            return on(middle + size * np.cos(angle), size * np.sin(angle))

        ends = [ends_of]
    return [side(1.0, last, backwards=False), *ends, side(-1.0, last, backwards=True)]


def naca_section(edge="sharp", back=0.0):
    """A section of 80 mm at a stagger of 25 deg."""
    pieces = naca(edge=edge, back=back)
    return Shape(chord=0.08, pieces=lambda _: [(lambda t, p=piece: turned(p(t), 25.0)) for piece in pieces])


def turned(points, angle):
    """Points turned about the origin [deg]."""
    a = np.radians(angle)
    return points @ np.array([[np.cos(a), np.sin(a)], [-np.sin(a), np.cos(a)]])


def on_cylinder(x, arc_length, radius):
    """Points of a cylinder about the x axis."""
    theta = arc_length / radius
    return np.stack([x, radius * np.sin(theta), radius * np.cos(theta)], axis=-1)


def twisted(edge="sharp", back=0.0, *, tip=False):
    """A blade of NACA sections on cylinders, twisted and tapered, 80 mm at the hub."""

    def pieces(share):
        return naca(chord=0.08 - 0.025 * share, thickness=0.12 - 0.04 * share, edge=edge, back=back)

    def place(points, share):
        flat = turned(points - (0.25 * (0.08 - 0.025 * share), 0.0), 30.0 + 20.0 * share)
        return on_cylinder(flat[:, 0], flat[:, 1], 0.2 + 0.12 * share)

    return Shape(chord=0.0675, pieces=pieces, place=place, tip=tip)


def radial_stator(angle=72.0):
    """A vane of a radial-inflow turbine: prismatic along x, its chord of 24 mm from outside inwards."""
    pieces = naca(chord=0.024, thickness=0.16, camber=0.05, place=0.4, edge="round", back=0.0004)

    def place(points, share):
        # from the leading edge outside, inwards and on in the sense of rotation
        flat = turned((points - (0.25 * 0.024, 0.0)) * (1.0, -1.0), 90.0 - angle)
        return np.stack([np.full(len(flat), 0.006 * share), flat[:, 0], 0.052 - flat[:, 1]], axis=-1)

    return Shape(chord=0.024, pieces=lambda _: pieces, place=place)


def radial_diffuser(inner=0.11, radius=0.15, length=0.06, thickness=0.0025, angle=65.0):
    """A vane of a diffuser: a plate bent to an arc, round at both ends, prismatic along x, from inside outwards."""
    reach = 0.5 * length / radius
    up = np.pi / 2.0
    first, last = (radius * direction(up + sign * reach) for sign in (1.0, -1.0))
    pieces = [
        arc(first, thickness / 2.0, up + reach + np.pi, up + reach),
        arc((0.0, 0.0), radius + thickness / 2.0, up + reach, up - reach),
        arc(last, thickness / 2.0, up - reach, up - reach - np.pi),
        arc((0.0, 0.0), radius - thickness / 2.0, up - reach, up + reach),
    ]

    def place(points, share):
        flat = turned((points - first) * (1.0, 1.0), 90.0 - angle)
        y, z = flat[:, 0], inner + flat[:, 1]
        width = 0.014 - 0.06 * (np.hypot(y, z) - inner)
        return np.stack([share * width, y, z], axis=-1)

    return Shape(chord=float(np.sqrt(np.sum((last - first) ** 2))) + thickness, pieces=lambda _: pieces, place=place)


def propeller(diameter=0.25, hub=0.028, tip=0.122):
    """A propeller's blade: NACA sections on cylinders by laws of chord, thickness, pitch, skew and rake."""

    def laws(share):
        x = 2.0 * (hub + (tip - hub) * share) / diameter
        chord = 0.5 * diameter * (0.35 + 0.55 * x - 0.62 * x**4)
        pitch = 1.1 * diameter * (1.0 - 0.5 * (x - 0.6) ** 2)
        return x, chord, pitch

    def pieces(share):
        chord = laws(share)[1]
        return naca(
            chord=chord, thickness=0.16 - 0.11 * share, camber=0.03, place=0.5, edge="round", back=0.008 * chord
        )

    def place(points, share):
        x, chord, pitch = laws(share)
        r = 0.5 * diameter * x
        phi = np.arctan(pitch / (2.0 * np.pi * r))
        flat = points - (0.5 * chord, 0.0)
        axial = flat[:, 0] * np.sin(phi) - flat[:, 1] * np.cos(phi) - 0.006 * share
        around = flat[:, 0] * np.cos(phi) + flat[:, 1] * np.sin(phi) + r * np.radians(25.0) * share**1.6
        return on_cylinder(axial, around, r)

    return Shape(chord=laws(0.5)[1], pieces=pieces, place=place)


EDGES = {"sharp": ("sharp", 0.0), "blunt": ("blunt", 0.0002), "round": ("round", 0.0006)}
"""kinds of the trailing edge of the NACA sections, and its thickness [m]"""
SHAPES = {
    "impulse-sharp": impulse,
    "impulse-thin": lambda: impulse(edge=0.00015),
    "orc-nozzle": nozzle,
    "radial-stator": radial_stator,
    "radial-diffuser": radial_diffuser,
    "ship-propeller": propeller,
    **{f"naca-{name}": (lambda kind=kind: naca_section(*kind)) for name, kind in EDGES.items()},
    **{f"twisted-{name}": (lambda kind=kind: twisted(*kind)) for name, kind in EDGES.items()},
    "twisted-tip": lambda: twisted(*EDGES["blunt"], tip=True),
}
"""shapes by name"""


def drawn(name, path):
    """A picture of a shape's cloud: its contour and edges, or three views."""
    import matplotlib.pyplot as plt

    shape = SHAPES[name]()
    points = shape.points(np.random.default_rng(0)) * 1e3
    planes = [(0, 1)] if points.shape[1] == 2 else [(0, 1), (1, 2), (0, 2)]
    figure, axes = plt.subplots(1, 3, figsize=(18, 6))
    for axis, (i, j) in zip(axes, planes, strict=False):
        axis.plot(points[:, i], points[:, j], ".", ms=1.5)
        axis.set(xlabel="xyz"[i], ylabel="xyz"[j], aspect="equal")
    if len(planes) == 1:
        for axis, end in zip(axes[1:], (np.argmin, np.argmax), strict=True):
            near = points[end(points[:, 0])]
            axis.plot(points[:, 0], points[:, 1], ".", ms=4)
            size = 0.03 * shape.chord * 1e3
            axis.set(xlim=near[0] + np.array([-size, size]), ylim=near[1] + np.array([-size, size]), aspect="equal")
    figure.suptitle(f"{name}, chord {shape.chord * 1e3:.1f} mm, {len(points)} points")
    figure.savefig(path, dpi=60)
    plt.close(figure)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--directory", type=Path, default=Path())
    options = parser.parse_args()
    for each in SHAPES:
        drawn(each, options.directory / f"{each}.png")
