"""Whether the thickness beside an edge can hold the edge's radius.

It does where the side's control points rise from the edge: the one that sets the radius may not stand higher above the
camber than the next one, which carries the thickness, or the side would bulge beyond the thickness asked for.
"""

import numpy as np

from bladewright.designs import Design
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals
from bladewright.section.laws import Span
from bladewright.section.sides import advances, edge_height


def check_edges(
    design: Design,
    name: str,
    line: Array,
    places: Reals,
    thickness: Array,
    curvatures: list[Array],
    weights: Array | None,
    span: Span,
) -> None:
    """Refuse edges that cannot be rounded: outward thickness, a radius too large for the thickness beside it.

    `line` (..., m, 4, 2) camber lines at the places of `span`; `thickness` (..., m, k) at the inner `places`;
    `curvatures` at leading and trailing edge (..., m); `weights` (..., m, n) or None.
    """
    reached = advances(line, places, thickness, name == "upper")
    count = len(getattr(design, f"thickness_{name}"))
    for i, edge in enumerate(("leading", "trailing")):
        entry = f"thickness_{name}[{0 if i == 0 else count - 1}]"
        radius = span.values(getattr(design, f"{edge}_edge_radius"))
        advance, curvature = np.real(reached[i]), np.real(curvatures[i])
        where = _first(advance <= 0.0)
        if where is not None:
            raise DesignError(
                f"{entry}: next to the {edge} edge at v = {span.v[where[-1]]:.3f} the {name} side leaves the blade "
                f"outwards: the camber turns too fast for the thickness there; lower {entry}, or the camber's turning"
            )
        where = _first(curvature <= 0.0)
        if where is not None:
            raise DesignError(
                f"{edge}_edge_radius is {_at(radius, where):.4g} at v = {span.v[where[-1]]:.3f}: the stream surface "
                f"there bends more than such an edge; lower {edge}_edge_radius"
            )
        ratio = 1.0
        if weights is not None:
            ends = np.real(weights if i == 0 else weights[..., ::-1])
            ratio = ends[..., 0] * ends[..., 2] / ends[..., 1] ** 2
        height = np.real(edge_height(advance, curvature, ratio))
        beside = np.real(thickness[..., 0 if i == 0 else -1])
        where = _first(height > beside)
        if where is not None:
            largest = _at(radius, where) * (_at(beside, where) / _at(height, where)) ** 2
            raise DesignError(
                f"{edge}_edge_radius is {_at(radius, where):.4g} at v = {span.v[where[-1]]:.3f}: the thickness of the "
                f"{name} side next to it can hold at most {largest:.4g}; lower {edge}_edge_radius or raise {entry}"
            )


def _first(mask: Array) -> tuple[int, ...] | None:
    found = np.argwhere(mask)
    return tuple(int(i) for i in found[0]) if len(found) else None


def _at(values: Array, where: tuple[int, ...]) -> float:
    return float(np.ravel(np.real(values)[..., where[-1]])[0])
