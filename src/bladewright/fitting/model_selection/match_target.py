"""What is asked of a match."""

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class MatchTarget:
    """What is asked of a match."""

    tolerance: float | None = None
    """largest distance of an inlier [m]"""
    parameters: int | None = None
    structured: bool = False
    """whether the structure is given"""

    @property
    def open(self) -> bool:
        """Whether nothing is asked for."""
        return self.tolerance is None and self.parameters is None and not self.structured
