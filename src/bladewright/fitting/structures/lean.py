"""The structures from which a match grows: few control points, where the cloud is to say how many it needs."""

from bladewright.fitting.structures.structure import SPANWISE, Structure


def lean(dimension: int, parameters: int | None) -> Structure:
    """A structure with few parameters, or one with nearly as many as are asked for, and no more."""
    if dimension == 2:
        count = 4 if parameters is None else min(4, max(2, (parameters - 10) // 2))
        return Structure(chordwise=(count, count))
    if parameters is None:
        return BLADES[1]
    return next((each for each in reversed(BLADES) if size_of(each) <= parameters), BLADES[0])


def rich(parameters: int | None) -> Structure:
    """The structure of a first blade, which finds its edges best with laws that are free enough."""
    return lean(3, max(parameters or 0, size_of(BLADES[-2])))


def size_of(structure: Structure) -> int:
    """Number of parameters of a structure."""
    thickness = sum(
        count * structure.span.get(name, 1)
        for name, count in zip(("thickness_upper", "thickness_lower"), structure.chordwise, strict=True)
    )
    if not structure.channel:
        return 10 + thickness
    laws = sum(count for name, count in structure.span.items() if not name.startswith("thickness"))
    return thickness + laws + 2 * (sum(structure.channel.values()) - 4)


def _blade(
    chordwise: int, thickness: int, angles: int, tangents: int, radii: int, channel: tuple[int, ...]
) -> Structure:
    span = {name: angles if name == "stagger" or "angle" in name else tangents for name in SPANWISE}
    span |= {name: radii for name in SPANWISE if name.endswith("radius")}
    return Structure(
        chordwise=(chordwise, chordwise),
        span={**span, "place": angles, "thickness_upper": thickness, "thickness_lower": thickness},
        channel=dict(zip(("leading_edge", "trailing_edge", "hub", "shroud"), channel, strict=True)),
    )


BLADES = (
    _blade(4, 1, 1, 1, 1, (2, 2, 2, 2)),
    _blade(5, 2, 3, 2, 1, (3, 3, 4, 4)),
    _blade(5, 3, 4, 3, 2, (3, 4, 4, 4)),
    _blade(6, 3, 4, 3, 2, (4, 5, 4, 4)),
    _blade(6, 4, 5, 4, 2, (4, 5, 4, 4)),
)
"""from a prismatic blade to one that is twisted and swept"""
