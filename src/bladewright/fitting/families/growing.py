"""Matches of the families that are one part with as many control points as are asked for, where they promise most."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

from bladewright.errors import DesignError
from bladewright.fitting.matching.search import Found, Task
from bladewright.fitting.structures.aim import Aim, short_of

WORTH = 0.9
"""ratio of misfits from which control points more are worth it where no aim is stated"""
PATIENCE = 2
"""times in a row that they may bring nothing before growth ends"""
GROWTHS = 30
FUTILE = "further control points bring the design hardly nearer to the points"

Wider = Callable[[Task, Found, Aim, int], Iterator[Found]]
"""matches near to one with control points more, in another way each time that so many have been taken back"""


def sufficient(task: Task, found: Found, aim: Aim, wider: Wider, *, coarse: float) -> tuple[Found, str]:
    """A match with as many control points as the aim asks for, or why there are no more.

    A step that brings the design no nearer is taken back, and another is tried. What is grown can be built, with native
    sides of the `coarse` tolerance.
    """
    best, idle, back = found, 0, 0
    for _ in range(GROWTHS):
        short, reason = short_of(found, aim, task)
        if not short or found.interrupted:
            met = not short and not reason
            return found if met or found.rms <= best.rms or aim.parameters is not None else best, reason
        tried = [each for each in wider(task, found, aim, back) if _allowed(each, aim) and sound(each, coarse)]
        if not tried and not back:
            return best, "no control point can be added to the design that leaves it one that can be built"
        fresh = min(tried, key=lambda each: each.rms, default=None)
        if fresh is None or (fresh.rms > found.rms and fresh.maximum > found.maximum):
            if back < PATIENCE and not (fresh is not None and fresh.interrupted):
                back += 1
                continue
            if fresh is None or aim.parameters is None:
                return best, FUTILE
        found, back = fresh, 0
        idle = idle + 1 if found.rms > WORTH * best.rms else 0
        best = found if found.rms < WORTH * best.rms or aim.parameters is not None else best
        if aim.open and idle > PATIENCE:
            return best, FUTILE
    return best, f"control points were added {GROWTHS} times, and no more are"


def sound(found: Found, tolerance: float) -> bool:
    """Whether the design can be built with a tolerance: whether its sections do not cross themselves."""
    design: Any = found.design
    try:
        replace(design, tolerance=max(design.tolerance, tolerance)).build()
    except DesignError:
        return False
    return True


def _allowed(found: Found, aim: Aim) -> bool:
    return aim.parameters is None or len(found.problem.paths) <= aim.parameters
