"""A fit as JSON has it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from bladewright.fitting.assessment.deviation import FIGURES, REGIONS, Deviation
from bladewright.fitting.assessment.text import unit_of_parameter

if TYPE_CHECKING:
    from bladewright.fitting.assessment.result import Estimate, Fit

LISTED_OUTLIERS = 1000
"""outliers that are listed; the count is that of all"""
MILLIMETRES = 1e3
"""millimetres in a metre"""


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
