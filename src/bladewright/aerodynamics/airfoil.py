"""A section as an airfoil: points around it in chords, as solvers of lone airfoils take them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from bladewright.aerodynamics.surface_flow import CUTS
from bladewright.errors import PolarError
from bladewright.frozen import FrozenRecord
from bladewright.numerics.elementary import Array, cross2, dot, frozen
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve
from bladewright.section.checks import UNITS
from bladewright.section.outline import Outline
from bladewright.section.planar import PlanarSection
from bladewright.section.section import Section

POINTS = 121
"""points of a side: XFOIL's panels, on a spline through them, then have cl within 1e-4 and cd within 1e-5 of those
through twice as many, and twice as many are more than it can hold unpanelled"""
FEWEST = 20
"""points around an airfoil: with fewer its spline has no nose"""
CUT = 0.05
"""chords; what is cut off a rounded trailing edge is no longer than this"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Airfoil(FrozenRecord):
    """A lone airfoil by points: `Airfoil(points=xy, chord=0.2)`, or `airfoil_of(section)`."""

    points: Reals
    """(n, 2) around it in chords, from the trailing edge over the upper side and the nose to the trailing edge; the
    chord line runs from (0, 0) to (1, 0)"""
    chord: float = 1.0
    """[m]"""
    nose: tuple[float, float] = (0.0, 0.0)
    """where the upper side meets the lower [chords]"""
    cuts: tuple[float, float] = CUTS
    """x/c at which each side is parted in leading edge, central box and trailing edge"""
    name: str = "airfoil"
    remarks: tuple[str, ...] = ()
    """what a polar of it must say: that it is one of a cascade, what was cut off"""

    def __post_init__(self) -> None:
        points = np.asarray(self.points, dtype=np.float64)
        if points.ndim != 2 or points.shape[1] != 2 or len(points) < FEWEST or not np.all(np.isfinite(points)):
            raise PolarError(
                f"the airfoil's points have the shape {points.shape}: give (n, 2) finite coordinates in chords, at "
                f"least {FEWEST}, from the trailing edge over the upper side and the nose back to the trailing edge"
            )
        x, y = points.T
        if np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)) < 0.0:
            points = points[::-1]
        if not self.chord > 0.0:
            raise PolarError(f"the airfoil's chord is {self.chord:g} m: it must be positive")
        object.__setattr__(self, "points", frozen(points))


def airfoil_of(section: Section) -> Airfoil:
    """The airfoil of a section of any family, its chord line turned level and its chord made one.

    Where the outline's own coordinates have another chord line than the straight one between its edges, as a morphed
    airfoil's, they hold. A round trailing edge is cut off one radius ahead of its end, square to the camber line, as
    solvers of airfoils take a sharp or a blunt one.
    """
    pitch = section.pitch
    in_a_cascade = pitch is not None or section.plane != "x-y"
    solidity = None if pitch is None else float(np.real(section.chord / pitch))
    remarks = [_of_a_cascade(section.name, solidity)] if in_a_cascade else []
    if section.outline is not None:
        chord = section.chord if section.reference_chord is None else section.reference_chord
        return _airfoil(_exact_shape(section.outline), section.name, float(np.real(chord)), remarks)
    return _airfoil(_curved_shape(section), section.name, float(np.real(section.chord)), remarks)


def exact_airfoil(design: PlanarSection, outline: Outline) -> Airfoil:
    """That of the section that a 2D design builds, from its exact outline alone: no curves are made."""
    chord = float(np.real(design.chord))
    remarks = [] if design.pitch is None else [_of_a_cascade(design.name, chord / float(np.real(design.pitch)))]
    return _airfoil(_exact_shape(outline), design.name, chord * UNITS[design.length_unit], remarks)


Line = Callable[[Reals], Reals]


@dataclass(frozen=True, kw_only=True, eq=False)
class _Shape:
    """A section in chords, by lines that give points (n, 2) at parameters (n,) in [0, 1]."""

    upper: Line
    lower: Line
    camber: Line
    radius: float
    """of a round trailing edge; 0: it is none"""
    cuts: tuple[float, float] = CUTS


def _exact_shape(outline: Outline) -> _Shape:
    def line(points: Callable[[Reals], Array]) -> Line:
        return lambda s: np.real(points(s)).reshape(-1, 2)

    radius, cuts = 0.0, CUTS
    if outline.trailing_edge.kind == "round":
        first, second = (np.real(each).reshape(2) for each in outline.trailing_edge.upper[1:])
        radius = float(dot(first, first) ** 1.5 / cross2(first, second))
    if outline.cuts is not None:
        front, rear = np.real(outline.points(np.array(outline.cuts))[0]).reshape(2, 2)[:, 0]
        cuts = float(front), float(rear)
    return _Shape(
        upper=line(lambda s: outline.points(s)[0]),
        lower=line(lambda s: outline.points(s)[1]),
        camber=line(outline.camber),
        radius=abs(radius),  # real: solvers take real points
        cuts=cuts,
    )


def _curved_shape(section: Section) -> _Shape:
    """That of a section without an outline, from its native curves."""
    ends = np.array([0.0, 1.0])
    upper, lower = (_complex(section.curves[name](ends)) for name in ("upper", "lower"))
    start, end = (upper + lower) / 2.0

    def line(curve: Curve) -> Line:
        def points(u: Reals) -> Reals:
            level = (_complex(curve(u)) - start) / (end - start)
            return np.stack([level.real, level.imag], axis=-1)

        return points

    radius = section.edge_radii[1] / float(np.real(section.chord)) if section.edges[1] == "round" else 0.0
    return _Shape(
        upper=line(section.curves["upper"]),
        lower=line(section.curves["lower"]),
        camber=line(section.camber),
        radius=radius,
    )


def _airfoil(shape: _Shape, name: str, chord: float, remarks: Sequence[str]) -> Airfoil:
    sides, radius, notes = (shape.upper, shape.lower), min(shape.radius, CUT), list(remarks)
    ends = [1.0, 1.0] if radius == 0.0 else [_cut(shape.camber, side, radius) for side in sides]
    if radius > 0.0:
        notes.append(
            f"the round trailing edge is cut off {radius:.3g} chords ahead of its end: solvers of airfoils take a "
            "sharp or a blunt one"
        )
    upper, lower = (_points(side, end) for side, end in zip(sides, ends, strict=True))
    lower = lower[1:] if np.allclose(upper[0], lower[0], rtol=0.0, atol=1e-12) else lower
    return Airfoil(
        points=np.concatenate([upper[::-1], lower]),
        chord=chord,
        nose=(float(upper[0, 0]), float(upper[0, 1])),
        cuts=shape.cuts,
        name=name,
        remarks=tuple(notes),
    )


def _complex(points: ArrayLike) -> np.ndarray:
    """Points (..., 2) of the real section as numbers x + iy."""
    real = np.real(np.asarray(points))
    return np.asarray(real[..., 0] + 1j * real[..., 1])


def _points(side: Line, end: float) -> Reals:
    """Points (n, 2) of a side up to the parameter `end`, denser towards its ends, by arc length."""
    u = np.linspace(0.0, end, 20 * POINTS)
    steps = np.hypot(*np.diff(side(u), axis=0).T)
    length = np.concatenate([[0.0], np.cumsum(steps)])
    places = length[-1] * (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, POINTS))) / 2.0
    return side(np.interp(places, length, u))


def _cut(camber: Line, side: Line, radius: float) -> float:
    """The parameter at which a side is `radius` ahead of the trailing edge, along the end of the camber line."""
    line = camber(np.array([0.99, 1.0]))
    along = (line[1] - line[0]) / np.hypot(*(line[1] - line[0]))

    def ahead(u: float) -> float:
        return float((side(np.array([u]))[0] - line[1]) @ along) + radius

    return 1.0 if ahead(0.5) > 0.0 or ahead(1.0) <= 0.0 else float(brentq(ahead, 0.5, 1.0))


def _of_a_cascade(name: str, solidity: float | None) -> str:
    """What a polar of a section of a cascade must say."""
    spacing = "" if solidity is None else f" at a solidity of {solidity:.3g}"
    return (
        f"'{name}' is a section of a cascade{spacing}, and this is the polar of the lone airfoil: neighbours "
        "turn the flow, so that neither lift nor drag are those of the cascade"
    )
