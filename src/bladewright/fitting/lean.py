"""The structures from which a match grows: few control points, where the cloud is to say how many it needs."""

from bladewright.fitting.structure import SPANWISE, Structure

PLENTY = 60
"""parameters from which a blade's laws may vary along the span from the first"""


def lean(dimension: int, parameters: int | None) -> Structure:
    """A structure with few parameters, and no more than are asked for."""
    if dimension == 2:
        count = 4 if parameters is None else min(4, max(2, (parameters - 10) // 2))
        return Structure(chordwise=(count, count))
    if parameters is not None and parameters < PLENTY:
        count = min(5, max(3, (parameters - 16) // 2))
        return Structure(
            chordwise=(count, count),
            span={**dict.fromkeys((*SPANWISE, "place"), 1), "thickness_upper": 1, "thickness_lower": 1},
            channel={"leading_edge": 2, "trailing_edge": 2, "hub": 2, "shroud": 2},
        )
    span = {name: 3 if "angle" in name or name == "stagger" else 2 if "tangent" in name else 1 for name in SPANWISE}
    return Structure(
        chordwise=(5, 5),
        span={**span, "place": 3, "thickness_upper": 2, "thickness_lower": 2},
        channel={"leading_edge": 3, "trailing_edge": 3, "hub": 4, "shroud": 4},
    )
