"""The flow in which an airfoil is looked at, and the numbers of a solver, with their limits."""

import math
from dataclasses import dataclass

from bladewright.errors import PolarError

REYNOLDS = (1e3, 1e9)
"""Reynolds numbers by the chord between which a boundary layer on an airfoil is what the solvers were made for"""
MACH = 0.75
"""above this the flow is transonic around any airfoil, and the solvers' compressibility correction fails"""
N_CRIT = (0.5, 18.0)
"""amplification exponents between a very turbulent stream and still air"""
PANELS = (60, 400)
"""fewer cannot follow a nose, and more do not fit into XFOIL's arrays"""


@dataclass(frozen=True, kw_only=True)
class Conditions:
    """The flow and the numbers of the solver; lengths are chords. Raises PolarError out of their limits."""

    reynolds: float
    """by the chord"""
    mach: float = 0.0
    n_crit: float = 9.0
    """logarithm of the amplification at which the e^n method sees transition"""
    transition: tuple[float, float] = (1.0, 1.0)
    """x/c at which transition is forced on the upper and the lower side; 1: nowhere"""
    moment_point: float = 0.25
    """x/c about which the moment is taken"""
    panels: int = 160
    iterations: int = 100
    """of the viscous solution at one angle"""
    time_limit: float = 60.0
    """of the whole polar [s]"""

    def __post_init__(self) -> None:
        _between("the Reynolds number by the chord", self.reynolds, *REYNOLDS, "check the unit of chord and reference")
        _between("mach", self.mach, 0.0, MACH, "a transonic airfoil needs another solver")
        _between("n_crit", self.n_crit, *N_CRIT, "9 is a clean wind tunnel")
        for side, place in zip(("upper", "lower"), self.transition, strict=True):
            _between(f"the forced transition of the {side} side", place, 0.0, 1.0, "1 forces it nowhere")
        _between("moment_point", self.moment_point, -10.0, 10.0, "it counts in chords from the leading edge")
        _between("panels", self.panels, *PANELS, "160 are XFOIL's own choice")
        _between("iterations", self.iterations, 1, 10_000, "100 are common")
        _between("time_limit", self.time_limit, 0.0, math.inf, "give seconds")


def _between(name: str, value: float, low: float, high: float, hint: str) -> None:
    if not low <= value <= high or math.isnan(value):
        raise PolarError(f"{name} is {value:g}: it must lie between {low:g} and {high:g}; {hint}")
