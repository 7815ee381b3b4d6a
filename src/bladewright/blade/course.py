"""The channel that a blade stands in, by its own parameter, and how far past the edges a place in it lies."""

from abc import ABC, abstractmethod
from dataclasses import dataclass

from bladewright.blade.streamlines import Channelled


@dataclass(frozen=True, kw_only=True, eq=False)
class Course(ABC):
    """A channel by its parameter u, which the leading and the trailing edge need not meet at 0 and 1."""

    channel: Channelled
    start: float
    """u down to which stream lines keep to the channel; straight beyond"""
    end: float
    """u up to which they do"""
    noses: tuple[float, float]
    """least and greatest u of the blade"""
    edges: tuple[float, float]
    """mean u of the leading and of the trailing edge"""
    length: float
    """mean meridional length of the blade [m]"""
    unit: float
    """how much of u one such length takes; on hub and shroud exactly, where the channel has ended"""

    @abstractmethod
    def extent(self, past: int, u: float) -> float:
        """How far u lies upstream of the leading (0), or downstream of the trailing edge (1), in mean lengths."""

    @abstractmethod
    def place(self, past: int, extent: float) -> float:
        """The u that lies so far past an edge, as `extent` counts it."""


@dataclass(frozen=True, kw_only=True, eq=False)
class OwnCourse(Course):
    """The channel of the unified family: u is 0 on the leading and 1 on the trailing edge, and counts extents."""

    def extent(self, past: int, u: float) -> float:
        return u - 1.0 if past else -u

    def place(self, past: int, extent: float) -> float:
        return 1.0 + extent if past else -extent
