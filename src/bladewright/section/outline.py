"""What every family's section is, exactly: two sides from leading to trailing edge, many sections at once."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Literal, NamedTuple

from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals


class Start(NamedTuple):
    """A side where it leaves an edge: value and derivatives by s (..., 2)."""

    point: Array
    first: Array
    second: Array


@dataclass(frozen=True, kw_only=True)
class Edge:
    """How the two sides of an outline meet at an edge."""

    kind: Literal["round", "sharp", "blunt"]
    """round: opposite first and equal second derivatives; sharp: one point; blunt: two points and a straight face"""
    upper: Start
    lower: Start


class Joint(NamedTuple):
    """Where both sides lose derivatives."""

    s: float
    derivatives: int
    """how many of them by s are continuous there"""


class Outline(ABC):
    """Sections (...) in chords: the chord line runs from (0, 0) to (1, 0), the upper side lies on its left.

    Both sides are functions of one parameter s, 0 at the leading and 1 at the trailing edge, smooth between the joints
    and up to the edges: where an edge is round, the upper side continued to -s is the lower side. What the numbers of a
    section decide may be complex; s, joints and kinds of edges are real, and the same for all sections.
    """

    @property
    @abstractmethod
    def leading_edge(self) -> Edge:
        """The meeting at s = 0."""

    @property
    @abstractmethod
    def trailing_edge(self) -> Edge:
        """The meeting at s = 1, its derivatives by s as well."""

    @property
    @abstractmethod
    def joints(self) -> tuple[Joint, ...]:
        """Places inside (0, 1), increasing."""

    @abstractmethod
    def points(self, s: Reals) -> tuple[Array, Array]:
        """Points (..., len(s), 2) of the upper and the lower side at s (k,) in [0, 1]."""

    @abstractmethod
    def camber(self, s: Reals) -> Array:
        """Points (..., len(s), 2) of the camber line at s (k,) in [0, 1], from (0, 0) to (1, 0)."""
