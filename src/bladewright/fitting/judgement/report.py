"""The report of a fit: for programs as plain numbers, for people as a short table."""

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from bladewright.designs import unit_at
from bladewright.fitting.judgement.deviation import REGIONS, Deviation

if TYPE_CHECKING:
    from bladewright.fitting.judgement.result import Estimate, Fit

LISTED = 1000
"""outliers that are listed; the count is that of all"""
FEW = 30
"""parameters up to which all of them stand in the text"""
FIGURES = ("mean", "rms", "percentile_99", "maximum")
MILLIMETRES = 1e3


def report(fit: "Fit") -> dict[str, Any]:
    """A fit as plain numbers, strings, lists and dictionaries, ready for JSON; what is not finite is None.

    Deviations are those of the inliers, each in metres, in millimetres and of the chord; a region without points has
    None. `outliers` lists the first 1000, by their index in the cloud. Estimates are in the units of their fields, and
    so are rows and columns of the covariance, in the same order.
    """
    chord = chord_of(fit)
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


def text(fit: "Fit") -> str:
    """A fit for people: whether it passes and why not, deviations by region in millimetres, then the parameters."""
    verdict = "passed" if fit.passed else "FAILED"
    state = ", interrupted" if fit.interrupted else ""
    lines = [f"{fit.design.name}: {verdict}{state}"]  # type: ignore[attr-defined]
    lines += [f"  - {failure}" for failure in fit.failures]
    lines += _table(fit)
    limits = [f"noise of the cloud {_mm(fit.noise)} mm"]
    if fit.tolerance is not None:
        limits.insert(0, f"tolerance {_mm(fit.tolerance)} mm")
    lines.append(f"  {', '.join(limits)}, chord {_mm(chord_of(fit), 6)} mm")
    lines += [f"  {line}" for line in (_said_of_outliers(fit), _said_of_motion(fit)) if line]
    waves = ", ".join(f"{count} on the {name} side" for name, count in fit.extrema.items())
    lines.append(f"  extrema of curvature: {waves}")
    lines.append(
        f"  {_counted(len(fit.estimates), 'free parameter')}, rank {fit.rank}, condition {fit.condition:.2g}, "
        f"{_counted(fit.evaluations, 'evaluation')}"
    )
    lines += _parameters(fit)
    lines += [f"  note: {note}" for note in fit.notes]
    return "\n".join(lines)


def chord_of(fit: "Fit") -> float:
    """The chord of what was built, the mean over the span [m]."""
    return float(np.real(fit.built.chord))


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


def unit_of_path(fit: "Fit", path: str) -> str:
    """Unit of a parameter: that of its field, the design's unit of length where it is one."""
    unit = unit_at(fit.design, path) or "-"
    return str(getattr(fit.design, "length_unit", unit)) if unit == "length" else unit


def _figures(deviation: Deviation | None, chord: float) -> dict[str, Any]:
    units = {"m": 1.0, "mm": MILLIMETRES, "of_chord": 1.0 / chord}
    known = deviation is not None and deviation.count > 0
    return {"count": deviation.count if deviation else 0} | {
        unit: {name: plain(getattr(deviation, name) * scale) if known else None for name in FIGURES}
        for unit, scale in units.items()
    }


def _outliers(fit: "Fit") -> dict[str, Any]:
    index = fit.outliers
    far = fit.distances[index]
    return {
        "count": len(index),
        "farthest_m": plain(np.max(far)) if len(index) else None,
        "listed": [
            {"index": int(i), "distance_m": plain(d), "distance_mm": plain(d * MILLIMETRES)}
            for i, d in zip(index[:LISTED], far[:LISTED], strict=True)
        ],
    }


def _worst(fit: "Fit") -> dict[str, Any] | None:
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


def _estimate(fit: "Fit", each: "Estimate") -> dict[str, Any]:
    return {
        "path": each.path,
        "unit": unit_of_path(fit, each.path),
        "value": plain(each.value),
        "standard_deviation": plain(each.deviation),
        "interval_95": [plain(each.low), plain(each.high)],
        "identified": bool(each.identified),
        "at_bound": bool(each.at_bound),
    }


def _motion(fit: "Fit") -> dict[str, Any]:
    assert fit.motion is not None  # noqa: S101 - the caller asks only where there is one
    return {
        "rotation": plain(fit.motion.rotation),
        "translation_m": plain(fit.motion.translation),
        "translation_mm": plain(fit.motion.translation * MILLIMETRES),
    }


def _table(fit: "Fit") -> list[str]:
    """Deviations of the inliers in millimetres, a row for each region."""
    chord = chord_of(fit)
    rows = [["deviation [mm]", "points", "mean", "rms", "99 %", "max", "max of chord"]]
    for name, of in {"all inliers": fit.deviation, **{name: fit.by_region.get(name) for name in REGIONS}}.items():
        if of is None or of.count == 0:
            # sections have no ends, but a cloud without points on an edge says nothing about it
            rows += [] if name == "ends" else [[name, "none", *"-----"]]
            continue
        figures = [_mm(getattr(of, figure)) for figure in FIGURES]
        rows.append([name, str(of.count), *figures, f"{of.maximum / chord:.1e}"])
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    return [
        "  " + f"{row[0]:<{widths[0]}}" + "".join(f"  {cell:>{widths[i]}}" for i, cell in enumerate(row) if i)
        for row in rows
    ]


def _said_of_outliers(fit: "Fit") -> str:
    count, total = len(fit.outliers), len(fit.cloud)
    if count == 0:
        return f"{_counted(total, 'point')}, no outliers"
    share = f"{100.0 * count / total:.2g} %"
    shown = ", ".join(str(i) for i in fit.outliers[:8])
    return (
        f"{_counted(total, 'point')}, {_counted(count, 'outlier')} ({share}) up to "
        f"{_mm(float(np.max(fit.distances[fit.outliers])))} mm away: number {shown}{', ...' if count > 8 else ''}"
    )


def _said_of_motion(fit: "Fit") -> str:
    if fit.motion is None:
        return ""
    turn, shift = np.asarray(fit.motion.rotation), np.asarray(fit.motion.translation)
    cosine = (np.trace(turn) - (1.0 if len(turn) == 3 else 0.0)) / 2.0
    angle = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
    moved = ", ".join(f"{value * MILLIMETRES:.6g}" for value in shift)
    return f"moved to the machine's axes: turned by {angle:.6g} deg, then shifted by ({moved}) mm"


def _parameters(fit: "Fit") -> list[str]:
    """A line for each parameter, or for each that the reader must look at where there are many."""
    doubtful = [each for each in fit.estimates if not each.identified or each.at_bound]
    shown = list(fit.estimates) if len(fit.estimates) <= FEW else doubtful
    width = max((len(each.path) for each in shown), default=0)
    lines = []
    for each in shown:
        asked = {"NOT IDENTIFIED": not each.identified, "AT BOUND": each.at_bound}
        marks = [word for word, holds in asked.items() if holds]
        value, spread = _with_spread(each)
        unit = unit_of_path(fit, each.path)
        lines.append(f"    {each.path:<{width}}  {value:>12}  {spread:<12}  {unit:<4} {', '.join(marks)}".rstrip())
    if len(shown) < len(fit.estimates):
        rest = len(fit.estimates) - len(shown)
        lines.append(f"    {'the others' if shown else 'all'} ({rest}) are identified and inside their bounds")
    return lines


def _with_spread(each: "Estimate") -> tuple[str, str]:
    """The value to the digits that are known, and half of its 95 % interval."""
    half = (each.high - each.low) / 2.0
    if not (each.identified and math.isfinite(half) and half > 0.0):
        return f"{each.value:.6g}", ""
    decimals = min(max(1 - math.floor(math.log10(half)), 0), 12)
    return f"{each.value:.{decimals}f}", f"+- {half:.2g}"


def _mm(metres: float, digits: int = 3) -> str:
    return f"{metres * MILLIMETRES:.{digits}g}"


def _counted(count: int, what: str) -> str:
    return f"{count} {what}{'' if count == 1 else 's'}"
