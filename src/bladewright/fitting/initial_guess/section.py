"""A first section from points in the plane."""

from functools import partial

import numpy as np

from bladewright.errors import DesignError, FitError
from bladewright.fitting.clouds.isolated import without_isolated_points
from bladewright.fitting.clouds.thinning import even_subset
from bladewright.fitting.design_header import Unit
from bladewright.fitting.initial_guess.camber import first_laws
from bladewright.fitting.initial_guess.feasibility import SHARPENINGS, simplified, with_sharper_edges
from bladewright.fitting.initial_guess.section_match import SectionMatch, matched_sections
from bladewright.fitting.initial_guess.section_shape import (
    ANGLE_IN,
    ANGLE_OUT,
    EXTENT,
    PLACE,
    ROOT_IN,
    ROOT_OUT,
    STAGGER,
    START,
    TANGENT_IN,
    TANGENT_OUT,
    SectionShape,
    UnwrappedPoints,
)
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import UNITS
from bladewright.section.unified import UnifiedSection

DRAWN_POINTS = 600
"""points that a first section is drawn through; it bounds the time."""


def first_section(
    points: Reals,
    *,
    chordwise: tuple[int, int] = (6, 6),
    samples: int = 16,
    clustering: float = 1.0,
    name: str = "blade",
    length_unit: Unit = "mm",
) -> UnifiedSection:
    """A section of the unified family near points (n, 2) [m], x axial and y tangential, found from them alone.

    `chordwise` are the control points of the upper and the lower thickness. Raises FitError where no section that can
    be built lies near the points.
    """
    points = without_isolated_points(np.unique(np.asarray(points, dtype=np.float64), axis=0))
    points = points[even_subset(points, DRAWN_POINTS)]
    middle = np.mean(points, axis=0)
    axis, chord = longest_chord(points)
    one = np.ones(len(points))
    shape = SectionShape(
        chordwise=chordwise,
        samples=samples,
        clustering=clustering,
        scale=lambda abscissa, _: np.ones_like(abscissa),
        extent=np.ones_like,
    )
    unwrapped = UnwrappedPoints(
        points=(points - middle) / chord, v=0.0 * one, size=one, chord=1.0, ratio=1.0, flat=True
    )
    match = best_match(shape, unwrapped, axis)
    return built_section(shape, match, middle, chord, name, length_unit)


def longest_chord(points: Reals) -> tuple[float, float]:
    """Direction [rad] of the longest distance between two points, towards +x, and that distance."""
    from scipy.spatial import ConvexHull

    corners = points[ConvexHull(points).vertices]
    apart = corners[:, None] - corners
    squares = np.sum(apart**2, axis=-1)
    i, j = np.unravel_index(int(np.argmax(squares)), squares.shape)
    along = apart[i, j] if apart[i, j, 0] > 0.0 else -apart[i, j]
    return float(np.arctan2(along[1], along[0])), float(np.sqrt(squares[i, j]))


def best_match(shape: SectionShape, unwrapped: UnwrappedPoints, axis: float) -> SectionMatch:
    """The nearest of matches that start from several directions of the chord."""
    found: list[SectionMatch] = []
    for turn in (0.0, 0.2, -0.2, 0.5, -0.5):
        direction = axis + turn
        if abs(axis + turn) > np.radians(88.0):
            continue
        laws = first_laws(shape, unwrapped, partial(np.full_like, fill_value=direction), np.zeros(1), 1)
        found.append(matched_sections(shape, unwrapped, laws))
        if found[-1].mean < 2e-3 * unwrapped.chord:
            break
    if not found:
        raise FitError("no chord")
    return min(found, key=lambda match: match.mean)


def built_section(
    shape: SectionShape, match: SectionMatch, middle: Reals, chord: float, name: str, length_unit: Unit
) -> UnifiedSection:
    """The section of a match, with edges made sharper or the shape simplified until it can be built."""
    numbers = match.laws[0].copy()
    metre = UNITS[length_unit]
    error: DesignError | None = None
    for attempt in range(SHARPENINGS + 6):
        extent = float(numbers[EXTENT])
        design = UnifiedSection(
            name=name,
            length_unit=length_unit,
            leading_edge_x=float((chord * numbers[START] + middle[0]) / metre),
            leading_edge_y=float((chord * numbers[PLACE] + middle[1]) / metre),
            axial_chord=float(chord * extent / metre),
            stagger=float(np.degrees(numbers[STAGGER])),
            metal_angle_in=float(np.degrees(numbers[ANGLE_IN])),
            metal_angle_out=float(np.degrees(numbers[ANGLE_OUT])),
            tangent_in=float(numbers[TANGENT_IN]),
            tangent_out=float(numbers[TANGENT_OUT]),
            leading_edge_radius=float(numbers[ROOT_IN] ** 2 / extent),
            trailing_edge_radius=float(numbers[ROOT_OUT] ** 2 / extent),
            thickness_upper=tuple(float(t / extent) for t in numbers[shape.upper]),
            thickness_lower=tuple(float(t / extent) for t in numbers[shape.lower]),
            samples=shape.samples,
            clustering=shape.clustering,
        )
        try:
            design.build()
        except DesignError as refused:
            error = refused
            numbers = (with_sharper_edges if attempt < SHARPENINGS else simplified)(numbers[None], shape)[0]
        else:
            return design
    raise FitError(f"no section that can be built was found near the points: {error}")
