"""A first blade from points in space."""

from itertools import product
from typing import Any

import numpy as np

from bladewright.blade.design.flow_path import Channel
from bladewright.blade.design.unified import UnifiedBlade
from bladewright.designs import Point
from bladewright.errors import DesignError, FitError
from bladewright.fitting.clouds.isolated import without_isolated_points
from bladewright.fitting.clouds.thinning import even_subset
from bladewright.fitting.design_header import Arrangement, Unit
from bladewright.fitting.initial_guess.arrangement import found_arrangement
from bladewright.fitting.initial_guess.channel import CHANNEL_CURVES, SPAN, RoughChannel, curve_counts
from bladewright.fitting.initial_guess.feasibility import SHARPENINGS, simplified, with_sharper_edges
from bladewright.fitting.initial_guess.hypotheses import machine_coordinates, ranked_outlines
from bladewright.fitting.initial_guess.section_shape import (
    ANGLE_IN,
    ANGLE_OUT,
    FIRST_THICKNESS,
    PLACE,
    ROOT_IN,
    ROOT_OUT,
    STAGGER,
    TANGENT_IN,
    TANGENT_OUT,
    numbers_at,
)
from bladewright.fitting.initial_guess.sections_in_channel import (
    SectionsInChannel,
    mean_distance,
    section_shape_in,
    transferred_sections,
    trimmed_channel,
)
from bladewright.fitting.model_selection.structure import Structure
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import UNITS
from bladewright.section.laws import law_basis
from bladewright.section.unified_limits import ANGLES, RADII, TANGENTS, THICKNESSES

LAW_LIMITS = {
    **dict.fromkeys(ANGLES, (-89.0, 89.0)),
    **dict.fromkeys(TANGENTS, (0.01, 1.0)),
    **dict.fromkeys(RADII, (1e-5, 0.95)),
    **dict.fromkeys(THICKNESSES, (1e-5, 9.0)),
}
"""limits of a first blade's laws, inside the family's own"""


AXES_HINT = "x must be the machine axis: say which column is which (--columns), or name the axis (--axis)"
"""what may be wrong with a cloud near which no blade is found"""


def built_blade(
    found: SectionsInChannel,
    arrangement: Arrangement,
    structure: Structure,
    blade_count: int | None,
    pitch: float | None,
    wide: float,
    name: str,
    length_unit: Unit,
) -> tuple[UnifiedBlade, int]:
    """The blade of what was found, simplified until it can be built, and how often it had to be."""
    metre = UNITS[length_unit]
    span = structure.span
    numbers = numbers_at(found.match.laws, SPAN)
    shape, channel = found.shape, found.channel
    lengths = channel.extents()[1]
    linear = arrangement == "linear"

    def law(values: Reals, field: str) -> float | tuple[float, ...]:
        count = span.get(field, 4)
        fitted = np.linalg.lstsq(law_basis(count, SPAN), values, rcond=None)[0]
        low, high = LAW_LIMITS.get(field, (-np.inf, np.inf))
        fitted = np.clip(fitted, low, high)
        return tuple(float(x) for x in fitted) if count > 1 else float(fitted[0])

    place = numbers[:, PLACE]
    most = float(np.max(lengths * np.max(numbers[:, FIRST_THICKNESS:], axis=1)))
    if linear:
        around = {"pitch": (pitch if pitch is not None else 2.0 * (wide + most)) / metre}
    else:
        count = blade_count if blade_count is not None else max(1, int(np.pi / max(wide, 1e-3)))
        around = {"blade_count": min(count, 10_000)}
    error: DesignError | None = None
    for attempt in range(SHARPENINGS + 6):
        roots = {ROOT_IN: numbers[:, ROOT_IN] ** 2, ROOT_OUT: numbers[:, ROOT_OUT] ** 2}
        fields: dict[str, Any] = {
            **around,
            "leading_edge_y" if linear else "leading_edge_theta": law(
                place / metre if linear else np.degrees(place), "place"
            ),
        }
        design = UnifiedBlade(
            name=name,
            length_unit=length_unit,
            arrangement=arrangement,
            **fields,
            stagger=law(np.degrees(numbers[:, STAGGER]), "stagger"),
            metal_angle_in=law(np.degrees(numbers[:, ANGLE_IN]), "metal_angle_in"),
            metal_angle_out=law(np.degrees(numbers[:, ANGLE_OUT]), "metal_angle_out"),
            tangent_in=law(numbers[:, TANGENT_IN], "tangent_in"),
            tangent_out=law(numbers[:, TANGENT_OUT], "tangent_out"),
            leading_edge_radius=law(np.clip(roots[ROOT_IN], 1e-5, 0.9), "leading_edge_radius"),
            trailing_edge_radius=law(np.clip(roots[ROOT_OUT], 1e-5, 0.9), "trailing_edge_radius"),
            thickness_upper=tuple(law(t, "thickness_upper") for t in numbers[:, shape.upper].T),
            thickness_lower=tuple(law(t, "thickness_lower") for t in numbers[:, shape.lower].T),
            channel=_as_channel(channel, metre),
            samples=shape.samples,
            clustering=shape.clustering,
        )
        try:
            design.build()
        except DesignError as refused:
            error = refused
            numbers = (with_sharper_edges if attempt < SHARPENINGS else simplified)(numbers, shape)
        else:
            return design, max(0, attempt - SHARPENINGS)
    raise FitError(f"no blade that can be built was found near the points ({error}); {AXES_HINT}")


def _as_channel(channel: RoughChannel, metre: float) -> Channel:
    def points(name: str, *, inner: bool = False) -> tuple[Point, ...]:
        rows = channel.curves[name] / metre
        return tuple(Point(float(x), float(r)) for x, r in (rows[1:-1] if inner else rows))

    return Channel(
        leading_edge=points("leading_edge"),
        trailing_edge=points("trailing_edge"),
        hub=points("hub", inner=True),
        shroud=points("shroud", inner=True),
    )


DRAWN_POINTS = 1200
"""points that a first blade is drawn through; it bounds the time."""
SETTLING_DISTANCE = 4e-3
"""mean distance, of the chord, with which no other outline is tried."""


def first_blade(
    points: Reals,
    *,
    arrangement: Arrangement | None = None,
    structure: Structure | None = None,
    blade_count: int | None = None,
    pitch: float | None = None,
    name: str = "blade",
    length_unit: Unit = "mm",
) -> UnifiedBlade:
    """A blade of the unified family near points (n, 3) [m] in the machine's axes, found from them alone.

    `pitch` [m] of a linear cascade. Where blade_count or pitch is not given, one is taken at which neighbours stand
    apart. Raises FitError where no blade that can be built lies near the points.
    """
    points = without_isolated_points(np.unique(np.asarray(points, dtype=np.float64), axis=0))
    points = points[even_subset(points, DRAWN_POINTS)]
    structure = structure or Structure()
    arrangement = arrangement or found_arrangement(points)
    machine, outlines = ranked_outlines(machine_coordinates(points, arrangement), revolved=arrangement == "annular")
    wide = float(np.ptp(machine[:, 2]))
    best: tuple[float, UnifiedBlade] | None = None
    refusal = FitError("no blade was found near the points")
    for outline, hold_sides in product(outlines[:3], (True, False)):
        found = _refined(outline, machine, structure, hold_sides=hold_sides)
        away = mean_distance(found, machine)
        if best is not None and away > best[0]:
            continue
        try:
            design, tamings = built_blade(found, arrangement, structure, blade_count, pitch, wide, name, length_unit)
        except FitError as error:
            refusal = error
            continue
        # a design that had to be simplified lies further from the points than its sections did
        away += 0.004 * tamings * found.unwrapped.chord
        if best is None or away < best[0]:
            best = away, design
        if best[0] < SETTLING_DISTANCE * found.unwrapped.chord:
            break
    if best is None:
        raise refusal
    return best[1]


def _refined(rough: SectionsInChannel, machine: Reals, structure: Structure, *, hold_sides: bool) -> SectionsInChannel:
    """The blade between the ends of its own camber lines, with the numbers of control points that are asked for.

    `hold_sides` holds points to the side that they seem to belong to.
    """
    count = 4 if len(machine) > 400 else 3
    found = rough
    for step in range(3):
        counts = (
            dict.fromkeys(CHANNEL_CURVES, 6) if step == 0 else dict(structure.channel) or curve_counts(found.channel)
        )
        channel = trimmed_channel(found, counts, machine, 0.05 if step == 0 else 0.15)
        shape = section_shape_in(channel, structure.chordwise, structure.samples, structure.clustering)
        found = transferred_sections(machine, channel, found, shape, count, ends=step == 2, hold_sides=hold_sides)
    return found
