"""A fit as people read it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from bladewright.designs import Design, unit_at
from bladewright.fitting.assessment.deviation import FIGURES, REGIONS
from bladewright.section.checks import UNITS

if TYPE_CHECKING:
    from bladewright.fitting.assessment.result import Estimate, Fit

FEW_PARAMETERS = 30
"""parameters up to which the text shows all of them; with more it shows the doubtful ones"""


def text(fit: Fit) -> str:
    """A fit for people: whether it passes and why not, deviations by region, then the parameters.

    Lengths are in the design's own unit.
    """
    verdict = "passed" if fit.passed else "FAILED"
    state = ", interrupted" if fit.interrupted else ""
    lines = [f"{fit.design.name}: {verdict}{state}"]  # type: ignore[attr-defined]
    lines += [f"  - {failure}" for failure in fit.failures]
    lines += _table(fit)
    limits = [f"noise of the cloud {with_unit(fit.design, fit.noise)}"]
    if fit.tolerance is not None:
        limits.insert(0, f"tolerance {with_unit(fit.design, fit.tolerance)}")
    lines.append(f"  {', '.join(limits)}, chord {with_unit(fit.design, fit.chord, 6)}")
    lines += [f"  {line}" for line in (_outliers_line(fit), _set_aside_line(fit), _motion_line(fit)) if line]
    waves = ", ".join(f"{count} on the {name} side" for name, count in fit.extrema.items())
    lines += [f"  extrema of curvature: {waves}"] if waves else []
    lines.append(
        f"  {_number_of(len(fit.estimates), 'free parameter')}, rank {fit.rank}, condition {fit.condition:.2g}, "
        f"{_number_of(fit.evaluations, 'evaluation')}"
    )
    lines += _parameters(fit)
    lines += [f"  note: {note}" for note in fit.notes]
    return "\n".join(lines)


def _table(fit: Fit) -> list[str]:
    """Deviations of the inliers, a row for each region."""
    chord = fit.chord
    rows = [[f"deviation [{unit_of_lengths(fit.design)}]", "points", "mean", "rms", "99 %", "max", "max of chord"]]
    for name, of in {"all inliers": fit.deviation, **{name: fit.by_region.get(name) for name in REGIONS}}.items():
        if of is None or of.count == 0:
            # sections have no ends, but a cloud without points on an edge says nothing about it
            rows += [] if name == "ends" else [[name, "none", *"-----"]]
            continue
        figures = [in_unit(fit.design, getattr(of, figure)) for figure in FIGURES]
        rows.append([name, str(of.count), *figures, f"{of.maximum / chord:.1e}"])
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    return [
        "  " + f"{row[0]:<{widths[0]}}" + "".join(f"  {cell:>{widths[i]}}" for i, cell in enumerate(row) if i)
        for row in rows
    ]


def _outliers_line(fit: Fit) -> str:
    count, total = len(fit.outliers), len(fit.cloud)
    if count == 0:
        return f"{_number_of(total, 'point')}, no outliers"
    share = f"{100.0 * count / total:.2g} %"
    shown = ", ".join(str(i) for i in fit.outliers[:8]) + (", ..." if count > 8 else "")
    farthest = with_unit(fit.design, float(np.max(fit.distances[fit.outliers])))
    return (
        f"{_number_of(total, 'point')}, {_number_of(count, 'outlier')} ({share}) up to {farthest} away: number {shown}"
    )


def _set_aside_line(fit: Fit) -> str:
    kinds = fit.by_kind_set_aside
    named = ", ".join(
        f"{each.count} on the {kind} (up to {with_unit(fit.design, each.maximum)} away)" for kind, each in kinds.items()
    )
    return f"set aside: {named}" if kinds else ""


def _motion_line(fit: Fit) -> str:
    if fit.motion is None:
        return ""
    turn, shift = np.asarray(fit.motion.rotation), np.asarray(fit.motion.translation)
    cosine = (np.trace(turn) - (1.0 if len(turn) == 3 else 0.0)) / 2.0
    angle = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
    moved = ", ".join(in_unit(fit.design, float(value), 6) for value in shift)
    unit = unit_of_lengths(fit.design)
    return f"moved to the machine's axes: turned by {angle:.6g} deg, then shifted by ({moved}) {unit}"


def _parameters(fit: Fit) -> list[str]:
    """A line for each parameter, or for each that the reader must look at where there are many."""
    doubtful = [each for each in fit.estimates if not each.identified or each.at_bound]
    shown = list(fit.estimates) if len(fit.estimates) <= FEW_PARAMETERS else doubtful
    width = max((len(each.path) for each in shown), default=0)
    lines = []
    for each in shown:
        conditions = {"NOT IDENTIFIED": not each.identified, "AT BOUND": each.at_bound}
        marks = [word for word, holds in conditions.items() if holds]
        value, spread = _with_spread(each)
        unit = unit_of_parameter(fit.design, each.path)
        lines.append(f"    {each.path:<{width}}  {value:>12}  {spread:<12}  {unit:<4} {', '.join(marks)}".rstrip())
    if len(shown) < len(fit.estimates):
        rest = len(fit.estimates) - len(shown)
        lines.append(f"    {'the others' if shown else 'all'} ({rest}) are identified and inside their bounds")
    return lines


def _with_spread(each: Estimate) -> tuple[str, str]:
    """The value to the digits that are known, and half of its 95 % interval."""
    half = (each.high - each.low) / 2.0
    if not (each.identified and math.isfinite(half) and half > 0.0):
        return f"{each.value:.6g}", ""
    decimals = min(max(1 - math.floor(math.log10(half)), 0), 12)
    return f"{each.value:.{decimals}f}", f"+- {half:.2g}"


def _number_of(count: int, what: str) -> str:
    return f"{count} {what}{'' if count == 1 else 's'}"


def unit_of_lengths(design: Design) -> str:
    """The design's unit of length."""
    return str(getattr(design, "length_unit", "mm"))


def in_unit(design: Design, metres: float, digits: int = 3) -> str:
    """A length [m] as a number of the design's unit."""
    return f"{metres / UNITS[unit_of_lengths(design)]:.{digits}g}"


def with_unit(design: Design, metres: float, digits: int = 3) -> str:
    """The same with the unit."""
    return f"{in_unit(design, metres, digits)} {unit_of_lengths(design)}"


def unit_of_parameter(design: Design, path: str) -> str:
    """Unit of a parameter: that of its field, the design's unit of length where it is one."""
    unit = unit_at(design, path) or "-"
    return unit_of_lengths(design) if unit == "length" else unit
