"""What sections in a flow path answer besides what all laid sections do."""

from abc import ABC, abstractmethod
from dataclasses import dataclass

from bladewright.blade.bladed_lines import BladedLines
from bladewright.blade.laid import Laid
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals


@dataclass(frozen=True, kw_only=True, eq=False)
class PathStations(Laid, ABC):
    """Sections at places v (m,) along the span of a flow path."""

    lines: BladedLines

    @abstractmethod
    def outlines(self) -> Reals:
        """Closed outlines (m, n, 2) in the sections' planes, of the real design, on which neighbours are judged."""

    @property
    def gathered(self) -> bool:
        return True

    def on_course(self, u: Array) -> Array:
        return self.lines.t(u)
