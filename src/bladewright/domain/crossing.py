"""The ways in which cross-lines of a wall's half leave an edge of the blade and turn back."""

from typing import NamedTuple


class Crossing(NamedTuple):
    """How cross-lines turn back from the lean with which they leave an edge."""

    ease: int
    """the power e: the smaller, the later they turn back, and the further the extension must reach"""
    lean: float
    """tangent of their least angle to the normal of the extension, times the camber's cosine"""
    fade: int = 16
    """power of 1 - t with which the lean fades from an edge along the blade"""
    quick: float = 0.5
    """how much faster than on average periodic boundaries pass the edges: the faster, the less they need to lean"""

    @property
    def bulge(self) -> float:
        """The greatest value of v (1 - v)^e."""
        share = self.ease / (self.ease + 1.0)
        return float((1.0 - share) * share**self.ease)


CROSSINGS = (Crossing(3, 1.0), Crossing(1, 1.0), Crossing(1, 2.0))
"""the ways that are tried in turn: most blades need the first, blunt ones beside narrow passages the others"""
GATHERED = (
    *(Crossing(each.ease, each.lean, fade=5, quick=-0.65) for each in CROSSINGS),
    Crossing(1, 3.0, fade=8, quick=1.0),
    Crossing(1, 5.0, fade=16, quick=1.5),
)
"""the same for sides whose parameter is gathered at their edges, the last two for corners beside a back face"""
