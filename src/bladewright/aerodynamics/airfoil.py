"""A section as an airfoil: points around it in chords, as solvers of lone airfoils take them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from bladewright.aerodynamics.surface_flow import CUTS
from bladewright.errors import PolarError
from bladewright.frozen import FrozenRecord
from bladewright.numerics.elementary import frozen
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve
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
    sides = {name: section.curves[name] for name in ("upper", "lower")}
    to_chords, chord = _to_chords(section)
    remarks = [_of_a_cascade(section)] if section.pitch is not None or section.plane != "x-y" else []
    ends = {"upper": 1.0, "lower": 1.0}
    if section.edges[1] == "round":
        radius = min(section.edge_radii[1] / float(np.real(section.chord)), CUT)
        ends = {name: _cut(section, to_chords, curve, radius) for name, curve in sides.items()}
        remarks.append(
            f"the round trailing edge is cut off {radius:.3g} chords ahead of its end: solvers of airfoils take a "
            "sharp or a blunt one"
        )
    upper, lower = (to_chords(_points(curve, ends[name])) for name, curve in sides.items())
    lower = lower[1:] if np.allclose(upper[0], lower[0], rtol=0.0, atol=1e-12) else lower
    return Airfoil(
        points=np.concatenate([upper[::-1], lower]),
        chord=chord,
        nose=(float(upper[0, 0]), float(upper[0, 1])),
        cuts=_cuts(section),
        name=section.name,
        remarks=tuple(remarks),
    )


def _to_chords(section: Section) -> tuple[Callable[[ArrayLike], Reals], float]:
    """The map from the section's plane to chords, and the chord [m]."""
    ends = np.array([0.0, 1.0])
    upper, lower = (_complex(section.curves[name](ends)) for name in ("upper", "lower"))
    start, end = (upper + lower) / 2.0
    if section.outline is None:
        first, last = 0.0 + 0.0j, 1.0 + 0.0j
    else:
        above, below = (_complex(np.reshape(side, (2, 2))) for side in section.outline.points(ends))
        first, last = (above + below) / 2.0
    turn = (last - first) / (end - start)

    def to_chords(points: ArrayLike) -> Reals:
        moved = first + turn * (_complex(points) - start)
        return np.stack([moved.real, moved.imag], axis=-1)

    return to_chords, float(np.real(section.chord)) / float(abs(last - first))  # real: solvers take real points


def _complex(points: ArrayLike) -> np.ndarray:
    """Points (..., 2) of the real section as numbers x + iy."""
    real = np.real(np.asarray(points))
    return np.asarray(real[..., 0] + 1j * real[..., 1])


def _points(curve: Curve, end: float) -> Reals:
    """Points (n, 2) of a side up to u = `end`, denser towards its ends, by arc length."""
    u = np.linspace(0.0, end, 20 * POINTS)
    points = np.real(curve(u))
    steps = np.hypot(*np.diff(points, axis=0).T)
    length = np.concatenate([[0.0], np.cumsum(steps)])
    places = length[-1] * (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, POINTS))) / 2.0
    return np.real(curve(np.interp(places, length, u)))


def _cut(section: Section, to_chords: Callable[[ArrayLike], Reals], curve: Curve, radius: float) -> float:
    """The u at which a side is `radius` [chords] ahead of the trailing edge, along the end of the camber line."""
    line = to_chords(section.camber(np.array([0.99, 1.0])))
    along = (line[1] - line[0]) / np.hypot(*(line[1] - line[0]))

    def ahead(u: float) -> float:
        return float((to_chords(curve(np.array([u])))[0] - line[1]) @ along) + radius

    return 1.0 if ahead(0.5) > 0.0 or ahead(1.0) <= 0.0 else float(brentq(ahead, 0.5, 1.0))


def _cuts(section: Section) -> tuple[float, float]:
    """x/c of the cuts of a segmented airfoil, or the common ones."""
    places = None if section.outline is None else section.outline.cuts
    if section.outline is None or places is None:
        return CUTS
    front, rear = np.real(section.outline.points(np.array(places))[0]).reshape(2, 2)[:, 0]
    return float(front), float(rear)


def _of_a_cascade(section: Section) -> str:
    """What a polar of a section of a cascade must say."""
    pitch = section.pitch
    spacing = f" at a solidity of {float(np.real(section.chord / pitch)):.3g}" if pitch is not None else ""
    return (
        f"'{section.name}' is a section of a cascade{spacing}, and this is the polar of the lone airfoil: neighbours "
        "turn the flow, so that neither lift nor drag are those of the cascade"
    )
