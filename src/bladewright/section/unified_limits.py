"""Limits of the unified family's parameters, each on its own, and of the edge radius that a thickness can hold."""

import numpy as np

from bladewright.designs import Design, Limits
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals
from bladewright.section import checks
from bladewright.section.laws import Span
from bladewright.section.unified_sides import advances, edge_height

ANGLES = ("stagger", "metal_angle_in", "metal_angle_out")
TANGENTS = ("tangent_in", "tangent_out")
RADII = ("leading_edge_radius", "trailing_edge_radius")
THICKNESSES = ("thickness_upper", "thickness_lower")
WEIGHTS = ("weights_upper", "weights_lower")
ANGLE = Limits(-90.0, 90.0, "an angle must lie between -90 and 90 deg")
TANGENT = Limits(0.0, 1.0 + 1e-12, "a tangent proportion must lie above 0 and not above 1, or the camber turns back")
RADIUS = Limits(0.0, 1.0, "an edge radius must lie between 0 and 1")
THICKNESS = Limits(0.0, 10.0, "thickness must be positive, and below 10; raise it")
WEIGHT = Limits(0.0, 1e6, "a weight must be positive, and below 1e6")
POSITIVE = Limits(0.0, float("inf"), "it must be positive")


def check_labels(design: Design) -> None:
    """Name, header texts and unit of length."""
    for label in ("name", "description", "author", "organisation"):
        checks.text(label, getattr(design, label))
    name = getattr(design, "name")  # noqa: B009 - a field of every family, not of the base
    if not name.strip() or any(sign in name for sign in '/\\:*?"<>|'):
        raise DesignError(f'name is {name!r}: it names files, so it must not be empty nor hold / \\ : * ? " < > |')
    checks.choice("length_unit", getattr(design, "length_unit"), list(checks.UNITS))  # noqa: B009 - as above


def check_sampling(design: Design) -> None:
    """Number and clustering of the samples along the chord."""
    samples = getattr(design, "samples")  # noqa: B009 - a field of every family, not of the base
    object.__setattr__(design, "samples", checks.integer("samples", samples, 3, 60, "a whole number is needed"))
    check_range(design, "clustering", 0.0, 1.0)


def check_range(design: Design, name: str, low: float, high: float) -> None:
    """A number from low to high."""
    object.__setattr__(design, name, checks.number(name, getattr(design, name)))
    checks.between(name, getattr(design, name), low, high, f"it must lie from {low:g} to {high:g}", closed=True)


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
    """Refuse edges that cannot be rounded: a side that leaves the edge outwards, a radius too large for the thickness.

    A side can have the edge's radius where its control points rise from the edge: the one that sets the radius must not
    lie higher above the camber than the next one, which carries the thickness, or the side would bulge beyond the
    thickness asked for.

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
        next_thickness = np.real(thickness[..., 0 if i == 0 else -1])
        where = _first(height > next_thickness)
        if where is not None:
            largest = _at(radius, where) * (_at(next_thickness, where) / _at(height, where)) ** 2
            raise DesignError(
                f"{edge}_edge_radius is {_at(radius, where):.4g} at v = {span.v[where[-1]]:.3f}: the thickness of the "
                f"{name} side next to it can hold at most {largest:.4g}; lower {edge}_edge_radius or raise {entry}"
            )


def _first(mask: Array) -> tuple[int, ...] | None:
    found = np.argwhere(mask)
    return tuple(int(i) for i in found[0]) if len(found) else None


def _at(values: Array, where: tuple[int, ...]) -> float:
    return float(np.ravel(np.real(values)[..., where[-1]])[0])
