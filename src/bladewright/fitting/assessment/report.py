"""The report of a fit: figures of its distances region by region, as JSON has them, and as people read them."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from bladewright.designs import Design, unit_at
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import UNITS

if TYPE_CHECKING:
    from bladewright.fitting.assessment.result import Estimate, Fit

REGIONS = ("sides", "leading edge", "trailing edge", "ends")
"""regions of a blade in which a point of a cloud may lie"""
FIGURES = ("mean", "rms", "percentile_99", "maximum")
"""figures of a deviation that are reported"""
LISTED_OUTLIERS = 1000
"""outliers that are listed; the count is that of all"""
MILLIMETRES = 1.0 / UNITS["mm"]
"""millimetres in a metre"""
FEW_PARAMETERS = 30
"""parameters up to which the text shows all of them; with more it shows the doubtful ones"""


@dataclass(frozen=True, kw_only=True)
class Deviation:
    """Distances of some points of a cloud from the surface [m]."""

    count: int
    mean: float
    rms: float
    percentile_99: float
    maximum: float

    def to_dict(self) -> dict[str, float]:
        """The figures, for JSON."""
        return asdict(self)


def deviation_of(distances: Reals) -> Deviation:
    """The figures of distances (n,) [m]; all 0 where there are none."""
    if len(distances) == 0:
        return Deviation(count=0, mean=0.0, rms=0.0, percentile_99=0.0, maximum=0.0)
    return Deviation(
        count=len(distances),
        mean=float(np.mean(distances)),
        rms=float(np.sqrt(np.mean(distances**2))),
        percentile_99=float(np.percentile(distances, 99.0)),
        maximum=float(np.max(distances)),
    )


def by_region(distances: Reals, regions: NDArray[np.str_]) -> dict[str, Deviation]:
    """The figures of each region that has points."""
    return {name: deviation_of(distances[regions == name]) for name in REGIONS if np.any(regions == name)}


def report(fit: Fit) -> dict[str, Any]:
    """A fit as plain numbers, strings, lists and dictionaries, ready for JSON; what is not finite is None.

    Deviations are those of the inliers, each in metres, in millimetres and of the chord; a region without points has
    None. `outliers` lists the first 1000, by their index in the cloud. Estimates are in the units of their fields, and
    so are rows and columns of the covariance, in the same order.
    """
    chord = fit.chord
    regions = fit.by_region
    return {
        "name": fit.design.name,  # type: ignore[attr-defined]
        "passed": fit.passed,
        "failures": list(fit.failures),
        "notes": list(fit.notes),
        "interrupted": fit.interrupted,
        "points": len(fit.cloud),
        "inliers": int(np.count_nonzero(fit.inliers)),
        "outliers": _outliers(fit),
        "set_aside": {kind: _figures(each, chord) for kind, each in fit.by_kind_set_aside.items()},
        "chord_m": plain(chord),
        "tolerance_m": plain(fit.tolerance),
        "tolerance_mm": plain(None if fit.tolerance is None else fit.tolerance * MILLIMETRES),
        "noise_m": plain(fit.noise),
        "noise_mm": plain(fit.noise * MILLIMETRES),
        "deviation": {
            "all": _figures(fit.deviation, chord),
            **{name: _figures(regions.get(name), chord) for name in REGIONS},
        },
        "worst": _worst(fit),
        "curvature_extrema": {name: int(count) for name, count in fit.extrema.items()},
        "parameters": len(fit.estimates),
        "rank": int(fit.rank),
        "condition": plain(fit.condition),
        "unidentified": list(fit.unidentified),
        "at_bounds": list(fit.at_bounds),
        "estimates": [_estimate(fit, each) for each in fit.estimates],
        "covariance": plain(fit.covariance),
        "motion": None if fit.motion is None else _motion(fit),
        "evaluations": int(fit.evaluations),
    }


def _figures(deviation: Deviation | None, chord: float) -> dict[str, Any]:
    units = {"m": 1.0, "mm": MILLIMETRES, "of_chord": 1.0 / chord}
    known = deviation is not None and deviation.count > 0
    return {"count": deviation.count if deviation else 0} | {
        unit: {name: plain(getattr(deviation, name) * scale) if known else None for name in FIGURES}
        for unit, scale in units.items()
    }


def _outliers(fit: Fit) -> dict[str, Any]:
    index = fit.outliers
    far = fit.distances[index]
    return {
        "count": len(index),
        "farthest_m": plain(np.max(far)) if len(index) else None,
        "listed": [
            {"index": int(i), "distance_m": plain(d), "distance_mm": plain(d * MILLIMETRES)}
            for i, d in zip(index[:LISTED_OUTLIERS], far[:LISTED_OUTLIERS], strict=True)
        ],
    }


def _worst(fit: Fit) -> dict[str, Any] | None:
    """The inlier that is farthest off."""
    index = np.flatnonzero(fit.inliers)
    if len(index) == 0:
        return None
    i = int(index[np.argmax(fit.distances[index])])
    return {
        "index": i,
        "point_m": plain(fit.cloud[i]),
        "region": str(fit.regions[i]),
        "place": str(fit.places[i]),
        "u": plain(fit.u[i]),
        "v": plain(fit.v[i]),
        "deviation_m": plain(fit.deviations[i]),
        "deviation_mm": plain(fit.deviations[i] * MILLIMETRES),
    }


def _estimate(fit: Fit, each: Estimate) -> dict[str, Any]:
    return {
        "path": each.path,
        "unit": unit_of_parameter(fit.design, each.path),
        "value": plain(each.value),
        "standard_deviation": plain(each.deviation),
        "interval_95": [plain(each.low), plain(each.high)],
        "identified": bool(each.identified),
        "at_bound": bool(each.at_bound),
    }


def _motion(fit: Fit) -> dict[str, Any]:
    assert fit.motion is not None  # noqa: S101 - the caller asks only where there is one
    return {
        "rotation": plain(fit.motion.rotation),
        "translation_m": plain(fit.motion.translation),
        "translation_mm": plain(fit.motion.translation * MILLIMETRES),
    }


def plain(value: Any) -> Any:
    """Numbers, arrays and sequences as JSON has them; None for what is not finite."""
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if value is None or isinstance(value, bool | int | str):
        return value
    number = float(value)
    return number if math.isfinite(number) else None


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
