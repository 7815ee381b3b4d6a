"""A cloud that lies anywhere in space, brought into the machine's axes before it is fitted."""

from typing import Any

from bladewright.designs import Design
from bladewright.fitting.judgement.result import Motion
from bladewright.nurbs.basis import Reals


def aligned(points: Reals, start: Design | None, arrangement: Any) -> tuple[Motion, Reals, Any, tuple[str, ...]]:
    """The motion, the points (n, d) after it, the arrangement where it was found, and what is to be said of them."""
    from bladewright.fitting.alignment import found_axes, registration

    if start is not None:
        registered = registration(points, start)  # type: ignore[arg-type]
        return registered.motion, registered.motion(points), arrangement, registered.notes
    found = found_axes(points, arrangement=arrangement)
    return found.motion, found.motion(points), found.arrangement, found.notes
