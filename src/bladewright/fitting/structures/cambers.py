"""Other first cambers of a section: an edge's direction shows in few points, and a search may end at a wrong one."""

from collections.abc import Callable

from bladewright.designs import Design
from bladewright.section.unified import UnifiedSection

TANGENT = 0.35
"""of a camber that is as plain as it can be"""
FOLLOWED = 0.6
"""turning from one edge to the chord, of that from the chord to the other edge, where one edge tells the other"""
STRAIGHT = {"tangent_*": (0.12, 1.0)}
"""bounds while a guess is far off: an edge that lies beside the nose would be reached by a hook of the camber"""


def cambers(design: UnifiedSection, free: Callable[[Design], tuple[str, ...]]) -> list[UnifiedSection]:
    """A section with turnings alike at both edges, as it is, and with either edge as the other tells; all its own free.

    What is not free stays.
    """
    into, out = design.metal_angle_in - design.stagger, design.metal_angle_out - design.stagger
    alike = (into - out) / 2.0
    changes: list[dict[str, float]] = [
        {"metal_angle_in": alike, "tangent_in": TANGENT, "metal_angle_out": -alike, "tangent_out": TANGENT},
        {},
        {"metal_angle_out": -FOLLOWED * into, "tangent_out": TANGENT},
        {"metal_angle_in": -out / FOLLOWED, "tangent_in": TANGENT},
    ]
    changeable = set(free(design))
    found = []
    for change in changes:
        turned = {name: value + (design.stagger if "angle" in name else 0.0) for name, value in change.items()}
        kept = {name: value for name, value in turned.items() if name in changeable and abs(value) < 88.0}
        found.append(design.changed(kept))
    return found
