"""Importing a T-Blade3 case as a design, with what was kept and changed, and points to measure it with."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from bladewright.blade.design.families import CurvatureMeanlineBlade
from bladewright.blade.exact.sectioned import exact_sectioned_blade
from bladewright.errors import DesignError, FileError
from bladewright.files.imported import Imported, most_blades_apart
from bladewright.files.tblade3.case import TBlade3Case
from bladewright.files.tblade3.reading import read_tblade3
from bladewright.files.tblade3.stacking import POINTS_PER_SIDE, chord_stations
from bladewright.files.tblade3.translation import CaseSections, blade_of, case_sections
from bladewright.nurbs.basis import Reals
from bladewright.section.laws import Span

MOST_POINTS = 1500
"""About the number of points with which the built sides are compared: more cost time in every import, and tell the
mean and the largest distance in more digits than are shown."""
_STATIONS = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, POINTS_PER_SIDE))) / 2.0


def section_points(sections: CaseSections, index: int, places: Reals) -> tuple[Reals, Reals]:
    """Points (k, 3) [m] of a section's upper and lower side at the outline's s (k,), by T-Blade3's formulas.

    They lie on the case's own stream line at its own m' and theta; neither the laws along the span nor the stream
    surfaces of the design are used.
    """
    outline = sections.numbers.of(index).outline(Span(np.zeros(1)))
    upper, lower = (point_in_space(sections, index, np.real(side)[0]) for side in outline.points(places))
    return upper, lower


def point_in_space(sections: CaseSections, index: int, chords: Reals) -> Reals:
    """Points in space (k, 3) [m] of points (k, 2) of a section in chords."""
    turn, chord = sections.stagger[index], sections.chords[index]
    along = chord * (chords[:, 0] * np.cos(turn) - chords[:, 1] * np.sin(turn))
    across = chord * (chords[:, 0] * np.sin(turn) + chords[:, 1] * np.cos(turn))
    line, total = sections.flow.lines[index], sections.flow.totals[index]
    x, r = np.real(line.values((sections.leading[index] + along) / total)).T
    theta = sections.theta[index] + across
    return np.stack([x, r * np.sin(theta), r * np.cos(theta)], axis=-1)


def written_points(case: TBlade3Case) -> Reals | None:
    """Points (m, n, 3) [m] of the sections in the file that T-Blade3 wrote next to the case; None where there is none.

    Each section runs from the trailing edge along the upper side, and back along the lower side.
    """
    path = Path(case.file).with_name(f"blade3d.{case.name}.dat")
    try:
        rows = [line.split() for line in path.read_text().splitlines() if line.strip()]
        count, sections = (int(word) for word in rows[0][:2])
        found = np.array(rows[1:], dtype=np.float64).reshape(sections, count, 3)
    except (OSError, ValueError, IndexError):
        return None
    if len(found) != len(case.sections) or count != 2 * POINTS_PER_SIDE - 1 or not np.all(np.isfinite(found)):
        return None
    return found * case.unit_length / case.scale


def import_tblade3(
    path: str | os.PathLike[str], *, edge_spline: bool = False, true_stagger: bool = False
) -> Imported[CurvatureMeanlineBlade]:
    """The blade of T-Blade3's main input file `3dbgbinput.R.dat` and the file of control points next to it.

    At every section of the case the design's section is T-Blade3's to rounding; between sections, where T-Blade3
    defines nothing, every parameter is a cubic spline. A leading edge spline is refused, or with `edge_spline` becomes
    the family's own. True sweep and lean use T-Blade3's wrong stagger, or with `true_stagger` the right one. Raises
    FileError, naming the file, where it is none of T-Blade3's, or asks for what the curvature-meanline family does not
    have.
    """
    case = read_tblade3(path)
    try:
        return _translated(case, edge_spline=edge_spline, true_stagger=true_stagger)
    except DesignError as error:
        raise FileError(f"'{case.file}': {error}") from error


def _translated(case: TBlade3Case, *, edge_spline: bool, true_stagger: bool) -> Imported[CurvatureMeanlineBlade]:
    if case.leading_edge == "spline" and not edge_spline:
        raise FileError(
            f"'{case.file}': the leading edges are splines (switch 1 on line 20), whose shape T-Blade3 takes from "
            "differences of rounding: the sections of its own example miss these edges and fold back on themselves, "
            "and make no blade; --edge-spline puts the family's spline with the same contacts, droop and elongation "
            "in their place, or set the switch to 0"
        )
    sections = case_sections(case, true_stagger=true_stagger)
    design, changed = blade_of(sections), list(_changed(sections))
    count = _count_apart(design, case.file)
    if count != case.blade_count:
        changed.append(
            f"{case.blade_count} blades would intersect, of which T-Blade3 says nothing: {count} are taken; set the "
            "true number"
        )
        design = design.changed("blade_count", count)
    points, source = _points(sections)
    return Imported(
        design=design,
        program="T-Blade3",
        kept=tuple(_kept(sections)),
        changed=tuple(changed),
        notes=(*case.unused, *case.notes),
        points=points,
        source=source,
    )


def _count_apart(design: CurvatureMeanlineBlade, file: str) -> int:
    """The number of the case's blades that do not intersect; raises FileError where its sections make no blade."""
    try:
        exact = exact_sectioned_blade(design)

        def check(count: int) -> None:
            replace(exact, design=design.changed("blade_count", count)).check()

        return most_blades_apart(int(design.blade_count or 1), check)
    except DesignError as error:
        raise FileError(f"'{file}': its sections make no blade: {error}") from error


def _points(sections: CaseSections) -> tuple[dict[str, Reals], str]:
    written = written_points(sections.case)
    if written is not None and not sections.true_stagger:
        sides = {"upper": written[:, :POINTS_PER_SIDE], "lower": written[:, POINTS_PER_SIDE - 1 :]}
        source = f"blade3d.{sections.case.name}.dat"
    else:
        both = [section_points(sections, i, _STATIONS) for i in range(len(sections.places))]
        sides = {name: np.stack([pair[k] for pair in both]) for k, name in enumerate(("upper", "lower"))}
        source = "its formulas" if sections.numbers.edges is None else "its formulas with these leading edges"
    every = max(1, 2 * POINTS_PER_SIDE * len(sections.places) // MOST_POINTS)
    return {name: points[:, ::every].reshape(-1, 3) for name, points in sides.items()}, source


def _kept(sections: CaseSections) -> Iterator[str]:
    case = sections.case
    yield (
        f"all {len(case.sections)} sections: meanline, thickness, stagger, chord and place, each law going through "
        "T-Blade3's values at them"
    )
    yield (
        "m' as T-Blade3 counts it, chords over mean radii (the plane counted-m'-theta), and its splines of the stream "
        "lines"
    )


def _changed(sections: CaseSections) -> Iterator[str]:
    case = sections.case
    if len(case.sections) > 2:
        yield (
            "between its sections T-Blade3 has no blade: here every number is a cubic spline through its values there, "
            "over a span fraction v that counts sections"
        )
    if sections.reversed:
        yield "the last streamline is the hub and the first the shroud, which lies to the left, seen along the flow"
    yield "stacking, lean and the turn of the blade are one law, leading_edge_theta"
    moved = np.max(np.abs(sections.leading - sections.flow.leading))
    if moved > 0.0 or not np.array_equal(sections.trailing, sections.flow.trailing):
        what = " and ".join(
            name
            for name, present in (("sweep", moved > 0.0), ("the sections' own chords", case.chord != "meridional"))
            if present
        )
        yield f"the edge curves go through the ends of the sections, as {what or 'the chords'} put them"
    if case.leading_edge == "spline":
        yield (
            "the leading edges are splines of the family, smooth at the contacts, their tips where T-Blade3 means its "
            "own; their other control points are not T-Blade3's, nor are the points of its sections there"
        )
    if sections.flow.dropped:
        yield (
            f"{sections.flow.dropped} points of the offset streamlines lie past the axis and are left out: the splines "
            "change by what such points do to them at the blade"
        )
    if case.angles == "wing":
        yield "twist and total camber of the wing are given as metal angles"
    if (case.true_sweep or case.true_lean) and (case.sweep.has_effect or case.lean.has_effect):
        if sections.true_stagger:
            yield "true lean and sweep follow the stagger of each section, which T-Blade3's do not"
        else:
            yield (
                "true lean and sweep are as T-Blade3 computes them: times the cosine of the inlet angle's degrees "
                "taken for radians, or of 0 where the chord is that between the edges; --true-stagger takes the "
                "stagger instead"
            )
    if any(each.centroid or each.above for each in case.stackings) and chord_stations(case) is None:
        yield (
            f"the stacking point is that of the exact section; T-Blade3 takes it from its 241 points, whose clustering "
            f"({case.clustering}) is not followed, so that theta may differ by some 1e-5 of the chord"
        )
    yield from (text for text in case.unsupported if "inflation" in text)
