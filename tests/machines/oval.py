"""The simplest family there is, by closed forms: what the shared contract tests are tried on."""

from dataclasses import dataclass

import numpy as np

from bladewright.designs import Law, parameter
from bladewright.numerics.elementary import radians
from bladewright.section import checks
from bladewright.section.family import SectionFamily
from bladewright.section.outline import Edge, EdgeDerivatives, Outline
from bladewright.section.planar import PlanarSection

PI = np.pi


@dataclass(frozen=True, kw_only=True)
class OvalOutline(Outline):
    """Camber v = 4 h u (1 - u), half thickness (T / 2) sin(pi s) across the chord, u = (1 - cos(pi s)) / 2."""

    height: np.ndarray
    thickness: np.ndarray

    def _edge(self, place, flip):
        starts = []
        for side in (1.0, -1.0):
            zero = 0.0 * (self.height + self.thickness)
            point = np.stack([zero + place, zero], axis=-1)
            first = np.stack([zero, side * self.thickness / 2 * PI * flip + zero], axis=-1)
            second = np.stack([zero + flip * PI**2 / 2, 4 * self.height * PI**2 / 2 + zero], axis=-1)
            starts.append(EdgeDerivatives(point, first, second))
        return Edge(kind="round", upper=starts[0], lower=starts[1])

    @property
    def leading_edge(self):
        return self._edge(0.0, 1.0)

    @property
    def trailing_edge(self):
        return self._edge(1.0, -1.0)

    @property
    def joints(self):
        return ()

    def points(self, s):
        line = self.camber(s)
        off = self.thickness[..., None] / 2 * np.sin(PI * s)
        across = np.stack([np.zeros_like(off), off], axis=-1)
        return line + across, line - across

    def camber(self, s):
        u = (1 - np.cos(PI * s)) / 2
        v = 4 * self.height[..., None] * u * (1 - u)
        return np.stack([u + 0 * v, v], axis=-1)


@dataclass(frozen=True, kw_only=True)
class Oval(SectionFamily):
    """An oval about a parabola."""

    stagger_angle: Law = parameter("deg")
    """angle of the chord line [deg]"""
    height: Law = parameter("-")
    """of the camber line above the chord line [-]"""
    thickness: Law = parameter("-")
    """across the chord line [-]"""

    def __post_init__(self):
        for name in ("stagger_angle", "height", "thickness"):
            object.__setattr__(self, name, checks.law(name, getattr(self, name)))

    def outline(self, span):
        return OvalOutline(height=span.values(self.height), thickness=span.values(self.thickness))

    def stagger(self, span):
        return radians(span.values(self.stagger_angle))


@dataclass(frozen=True, kw_only=True)
class OvalSection(PlanarSection):
    """An oval in the plane."""

    section: Oval


OVAL = OvalSection(
    name="oval",
    length_unit="mm",
    chord=40.0,
    pitch=50.0,
    section=Oval(stagger_angle=20.0, height=0.05, thickness=0.12),
)
