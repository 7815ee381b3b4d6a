"""What a fit hands back: the design, how well it matches the cloud, and its report for JSON and for people."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from bladewright.designs import Design, unit_at
from bladewright.display import Shown
from bladewright.fitting.assessment.deviation import FIGURES, REGIONS, Deviation, by_region, deviation_of
from bladewright.frozen import FrozenRecord
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import UNITS

LISTED_OUTLIERS = 1000
"""outliers that are listed; the count is that of all"""
MILLIMETRES = 1.0 / UNITS["mm"]
"""millimetres in a metre"""
FEW_PARAMETERS = 30
"""parameters up to which the text shows all of them; with more it shows the doubtful ones"""


@dataclass(frozen=True, kw_only=True)
class Motion:
    """A rigid motion: `points @ rotation.T + translation`."""

    rotation: Reals
    """(3, 3)"""
    translation: Reals
    """(3,) [m]"""

    def __call__(self, points: Reals) -> Reals:
        """Moved points (..., 3)."""
        return points @ self.rotation.T + self.translation


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """A fitted parameter, in the unit of its field."""

    path: str
    value: float
    deviation: float
    """standard deviation that the cloud's noise gives it; infinite where the cloud does not determine it"""
    low: float
    """lower end of the 95 % interval"""
    high: float
    """upper end of the 95 % interval"""
    identified: bool
    """whether the cloud determines it"""
    at_bound: bool
    """whether it lies on one of its bounds"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Fit(FrozenRecord, Shown):
    """A design fitted to a cloud of n points, and what it reaches; points are in the order of the cloud."""

    shown_as: ClassVar[str] = "fit"

    design: Design
    """a `UnifiedBlade`, or a `UnifiedSection` for a cloud in the plane"""
    built: Any
    """what the design builds: a `Blade` or a `Section`"""
    cloud: Reals
    """(n, 2) or (n, 3) the points in the machine's axes, after `motion` where there is one [m]"""
    places: NDArray[np.str_]
    """(n,) name of the nearest curve or surface: `upper`, `lower`, or one of the blade's ends or faces"""
    u: Reals
    """(n,) parameter of the nearest place along the chord"""
    v: Reals
    """(n,) parameter of the nearest place along the span; 0 for a section"""
    deviations: Reals
    """(n,) distance from the nearest place, positive outside the blade [m]"""
    regions: NDArray[np.str_]
    """(n,) region of each point: `sides`, `leading edge`, `trailing edge` or `ends`"""
    inliers: NDArray[np.bool_]
    """(n,) whether a point took part; the others are outliers, or set aside"""
    set_aside: NDArray[np.str_]
    """(n,) what a point lies on that is none of the sides, such as `hub fillet`; empty where it took part"""
    estimates: tuple[Estimate, ...]
    """the free parameters"""
    covariance: Reals
    """(k, k) of the free parameters, in their order and the units of their fields"""
    rank: int
    """number of directions in the space of the parameters that the cloud determines"""
    condition: float
    """ratio of the largest to the smallest singular value of the scaled problem"""
    noise: float
    """standard deviation of the cloud's own noise, as neighbouring points show it [m]"""
    extrema: Mapping[str, int]
    """number of extrema of the curvature of each side, the most of any section; empty where sections cannot be made"""
    tolerance: float | None
    """largest distance of an inlier that was asked for [m]"""
    failures: tuple[str, ...]
    """why the fit does not pass, each a sentence"""
    notes: tuple[str, ...]
    """what else there is to know, each a sentence"""
    evaluations: int
    """of the surface during the fit"""
    motion: Motion | None = None
    """the rigid motion from the points as given to the machine's axes"""
    interrupted: bool = False

    @property
    def passed(self) -> bool:
        """Whether nothing failed."""
        return not self.failures

    @property
    def distances(self) -> Reals:
        """(n,) true distances from the surface [m]."""
        return np.sqrt(self.deviations**2)

    @cached_property
    def deviation(self) -> Deviation:
        """Of all inliers."""
        return deviation_of(self.distances[self.inliers])

    @cached_property
    def by_region(self) -> dict[str, Deviation]:
        """Of the inliers of each region."""
        return by_region(self.distances[self.inliers], self.regions[self.inliers])

    @cached_property
    def by_kind_set_aside(self) -> dict[str, Deviation]:
        """Of the points that are set aside, by what they lie on."""
        kinds = np.unique(self.set_aside[self.set_aside != ""])
        return {str(kind): deviation_of(self.distances[self.set_aside == kind]) for kind in kinds}

    @property
    def mean(self) -> float:
        """Mean distance of the inliers [m]."""
        return self.deviation.mean

    @property
    def maximum(self) -> float:
        """Largest distance of an inlier [m]."""
        return self.deviation.maximum

    @property
    def chord(self) -> float:
        """Chord of what was built, the mean over the span [m]."""
        return float(np.real(self.built.chord))

    @property
    def outliers(self) -> NDArray[np.intp]:
        """Indices of the points that are outliers."""
        return np.flatnonzero(~self.inliers & (self.set_aside == ""))

    @property
    def unidentified(self) -> tuple[str, ...]:
        """Parameters that the cloud does not determine."""
        return tuple(each.path for each in self.estimates if not each.identified)

    @property
    def at_bounds(self) -> tuple[str, ...]:
        """Parameters that lie on one of their bounds."""
        return tuple(each.path for each in self.estimates if each.at_bound)

    def to_dict(self) -> dict[str, Any]:
        """The report, for JSON; lengths in metres."""
        return report(self)

    def __repr__(self) -> str:
        verdict, points = "passed" if self.passed else "FAILED", f"{len(self.cloud)} points"
        off = f"mean {self.mean:.3g} m, largest {self.maximum:.3g} m"
        name = getattr(self.design, "name", "")
        return f"<Fit '{name}' of {type(self.design).__name__}: {verdict}; {points}, {off}>"

    def __str__(self) -> str:
        return text(self)


def report(fit: Fit) -> dict[str, Any]:
    """A fit as plain numbers, strings, lists and dictionaries, ready for JSON; what is not finite is None.

    Deviations are those of the inliers, each in metres, in millimetres and of the chord; a region without points has
    None. `outliers` lists the first 1000, by their index in the cloud. Estimates are in the units of their fields, and
    so are rows and columns of the covariance, in the same order.
    """
    chord, regions, motion = fit.chord, fit.by_region, fit.motion
    far = fit.distances[fit.outliers]
    listed = zip(fit.outliers[:LISTED_OUTLIERS], far[:LISTED_OUTLIERS], strict=True)
    return {
        "name": fit.design.name,  # type: ignore[attr-defined]
        "passed": fit.passed,
        "failures": list(fit.failures),
        "notes": list(fit.notes),
        "interrupted": fit.interrupted,
        "points": len(fit.cloud),
        "inliers": int(np.count_nonzero(fit.inliers)),
        "outliers": {
            "count": len(far),
            "farthest_m": plain(np.max(far)) if len(far) else None,
            "listed": [{"index": int(i), **_in_units("distance", d)} for i, d in listed],
        },
        "set_aside": {kind: _figures(each, chord) for kind, each in fit.by_kind_set_aside.items()},
        "chord_m": plain(chord),
        **_in_units("tolerance", fit.tolerance),
        **_in_units("noise", fit.noise),
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
        "estimates": [
            {
                "path": each.path,
                "unit": unit_of_parameter(fit.design, each.path),
                "value": plain(each.value),
                "standard_deviation": plain(each.deviation),
                "interval_95": [plain(each.low), plain(each.high)],
                "identified": bool(each.identified),
                "at_bound": bool(each.at_bound),
            }
            for each in fit.estimates
        ],
        "covariance": plain(fit.covariance),
        "motion": motion and {"rotation": plain(motion.rotation), **_in_units("translation", motion.translation)},
        "evaluations": int(fit.evaluations),
    }


def _in_units(name: str, metres: Any) -> dict[str, Any]:
    """Lengths in metres and in millimetres; None of what is not there."""
    return {f"{name}_m": plain(metres), f"{name}_mm": plain(None if metres is None else metres * MILLIMETRES)}


def _figures(deviation: Deviation | None, chord: float) -> dict[str, Any]:
    units = {"m": 1.0, "mm": MILLIMETRES, "of_chord": 1.0 / chord}
    known = deviation is not None and deviation.count > 0
    return {"count": deviation.count if deviation else 0} | {
        unit: {name: plain(getattr(deviation, name) * scale) if known else None for name in FIGURES}
        for unit, scale in units.items()
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
        **_in_units("deviation", fit.deviations[i]),
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
    design, count = fit.design, len(fit.outliers)
    verdict, state = "passed" if fit.passed else "FAILED", ", interrupted" if fit.interrupted else ""
    lines = [f"{design.name}: {verdict}{state}"]  # type: ignore[attr-defined]
    lines += [f"  - {failure}" for failure in fit.failures]
    lines += _table(fit)
    tolerance = "" if fit.tolerance is None else f"tolerance {with_unit(design, fit.tolerance)}, "
    lines.append(
        f"  {tolerance}noise of the cloud {with_unit(design, fit.noise)}, chord {with_unit(design, fit.chord, 6)}"
    )
    outliers = "no outliers"
    if count:
        shown = ", ".join(str(i) for i in fit.outliers[:8]) + (", ..." if count > 8 else "")
        farthest = with_unit(design, np.max(fit.distances[fit.outliers]))
        share = f"({100.0 * count / len(fit.cloud):.2g} %) up to {farthest} away"
        outliers = f"{_number_of(count, 'outlier')} {share}: number {shown}"
    lines.append(f"  {_number_of(len(fit.cloud), 'point')}, {outliers}")
    set_aside = ", ".join(
        f"{each.count} on the {kind} (up to {with_unit(design, each.maximum)} away)"
        for kind, each in fit.by_kind_set_aside.items()
    )
    lines += [f"  set aside: {set_aside}"] if set_aside else []
    if fit.motion is not None:
        turn = np.asarray(fit.motion.rotation)
        cosine = (np.trace(turn) - (1.0 if len(turn) == 3 else 0.0)) / 2.0
        angle = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
        shift = f"({', '.join(in_unit(design, each, 6) for each in fit.motion.translation)}) {unit_of_lengths(design)}"
        lines.append(f"  moved to the machine's axes: turned by {angle:.6g} deg, then shifted by {shift}")
    waves = ", ".join(f"{number} on the {name} side" for name, number in fit.extrema.items())
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
