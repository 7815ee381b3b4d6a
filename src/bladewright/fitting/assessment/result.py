"""What a fit hands back: the design, how well it matches the cloud, and its report for JSON and for people."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from bladewright.designs import Design, unit_at
from bladewright.display import Shown
from bladewright.fitting.assessment.measurement import (
    FIGURES,
    Deviation,
    ParameterEstimates,
    PlacesOfPoints,
    deviation_of,
)
from bladewright.frozen import FrozenRecord
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import UNITS

LISTED_OUTLIERS = 1000
"""outliers that are listed; the count is that of all"""
MILLIMETRES = 1.0 / UNITS["mm"]
"""millimetres in a metre"""
FEW_PARAMETERS = 30
"""parameters up to which the text shows all of them; with more it shows the doubtful ones"""
REGIONS = ("sides", "leading edge", "trailing edge", "ends")
"""regions of a blade in which a point of a cloud may lie"""


@dataclass(frozen=True, kw_only=True)
class Motion:
    """A rigid motion in d dimensions: `points @ rotation.T + translation`."""

    rotation: Reals
    """(d, d)"""
    translation: Reals
    """(d,) [m]"""

    def __call__(self, points: Reals) -> Reals:
        """Moved points (..., d)."""
        return points @ self.rotation.T + self.translation

    def after(self, first: Motion | None) -> Motion:
        """The motion that does `first`, if any, then this one."""
        if first is None:
            return self
        return Motion(rotation=self.rotation @ first.rotation, translation=self(first.translation))


@dataclass(frozen=True, kw_only=True, eq=False)
class Fit(PlacesOfPoints, ParameterEstimates, FrozenRecord, Shown):
    """A design fitted to a cloud of n points, and what it reaches; points are in the order of the cloud."""

    shown_as: ClassVar[str] = "fit"

    design: Design
    """a blade of the family, or a section for a cloud in the plane"""
    built: Any
    """what the design builds: a `Blade` or a `Section`"""
    cloud: Reals
    """(n, 2) or (n, 3) the points in the machine's axes, after `motion` where there is one [m]"""
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

    @cached_property
    def by_region(self) -> dict[str, Deviation]:
        """Of the inliers of each region that has some."""
        found = {name: deviation_of(self.distances[self.inliers & (self.regions == name)]) for name in REGIONS}
        return {name: each for name, each in found.items() if each.count}

    @cached_property
    def by_kind_set_aside(self) -> dict[str, Deviation]:
        """Of the points that are set aside, by what they lie on."""
        kinds = [str(kind) for kind in np.unique(self.set_aside) if kind]
        return {kind: deviation_of(self.distances[self.set_aside == kind]) for kind in kinds}

    @property
    def chord(self) -> float:
        """Chord of what was built, the mean over the span [m]."""
        return float(np.real(self.built.chord))

    def to_dict(self) -> dict[str, Any]:
        """The report: plain numbers, strings, lists and dictionaries, ready for JSON; what is not finite is None.

        Deviations are those of the inliers, each in metres, in millimetres and of the chord; a region without points
        has None. `outliers` lists the first 1000, by their index in the cloud. Estimates are in the units of their
        fields, and so are rows and columns of the covariance, in the same order.
        """
        off, chord, motion = self.distances[self.outliers], self.chord, self.motion
        regions = {name: self.by_region.get(name, deviation_of(np.empty(0))) for name in REGIONS}
        found = {
            "name": self.design.name,  # type: ignore[attr-defined]
            "passed": self.passed,
            "failures": self.failures,
            "notes": self.notes,
            "interrupted": self.interrupted,
            "points": len(self.cloud),
            "inliers": np.count_nonzero(self.inliers),
            "outliers": {
                "count": len(off),
                "farthest_m": np.max(off, initial=-np.inf),
                "listed": [
                    {"index": i, **_in_units("distance", self.distances[i])} for i in self.outliers[:LISTED_OUTLIERS]
                ],
            },
            "set_aside": {kind: _figures(each, chord) for kind, each in self.by_kind_set_aside.items()},
            "chord_m": chord,
            **_in_units("tolerance", self.tolerance),
            **_in_units("noise", self.noise),
            "deviation": {name: _figures(of, chord) for name, of in {"all": self.deviation, **regions}.items()},
            "worst": _worst(self),
            "curvature_extrema": dict(self.extrema),
            "parameters": len(self.estimates),
            "rank": self.rank,
            "condition": self.condition,
            "unidentified": self.unidentified,
            "at_bounds": self.at_bounds,
            "estimates": [
                {
                    "path": each.path,
                    "unit": unit_of_parameter(self.design, each.path),
                    "value": each.value,
                    "standard_deviation": each.deviation,
                    "interval_95": (each.low, each.high),
                    "identified": each.identified,
                    "at_bound": each.at_bound,
                }
                for each in self.estimates
            ],
            "covariance": self.covariance,
            "motion": motion and {"rotation": motion.rotation, **_in_units("translation", motion.translation)},
            "evaluations": self.evaluations,
        }
        return dict(plain(found))

    def __repr__(self) -> str:
        verdict, points = "passed" if self.passed else "FAILED", f"{len(self.cloud)} points"
        off = f"mean {self.mean:.3g} m, largest {self.maximum:.3g} m"
        name = getattr(self.design, "name", "")
        return f"<Fit '{name}' of {type(self.design).__name__}: {verdict}; {points}, {off}>"

    def __str__(self) -> str:
        """For people: whether it passes and why not, deviations by region, parameters; in the design's own unit."""
        design, off = self.design, self.distances[self.outliers]
        result = ("passed" if self.passed else "FAILED") + (", interrupted" if self.interrupted else "")
        tolerance = "" if self.tolerance is None else f"tolerance {with_unit(design, self.tolerance)}, "
        noise, chord = with_unit(design, self.noise), with_unit(design, self.chord, 6)
        outliers = "no outliers"
        if len(off):
            listed = ", ".join(str(i) for i in self.outliers[:8]) + (", ..." if len(off) > 8 else "")
            share = f"({100.0 * len(off) / len(self.cloud):.2g} %) up to {with_unit(design, np.max(off))} away"
            outliers = f"{_number_of(len(off), 'outlier')} {share}: number {listed}"
        lines = [
            f"{design.name}: {result}",  # type: ignore[attr-defined]
            *(f"  - {failure}" for failure in self.failures),
            *_table(self),
            f"  {tolerance}noise of the cloud {noise}, chord {chord}",
            f"  {_number_of(len(self.cloud), 'point')}, {outliers}",
        ]
        if self.by_kind_set_aside:
            parts = [
                f"{each.count} on the {kind} (up to {with_unit(design, each.maximum)} away)"
                for kind, each in self.by_kind_set_aside.items()
            ]
            lines.append(f"  set aside: {', '.join(parts)}")
        if self.motion is not None:
            cosine = (np.trace(self.motion.rotation) - (len(self.motion.rotation) - 2)) / 2.0
            angle = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
            shift = ", ".join(in_unit(design, each, 6) for each in self.motion.translation)
            unit = unit_of_lengths(design)
            lines.append(f"  moved to the machine's axes: turned by {angle:.6g} deg, then shifted by ({shift}) {unit}")
        if self.extrema:
            counts = ", ".join(f"{number} on the {name} side" for name, number in self.extrema.items())
            lines.append(f"  extrema of curvature: {counts}")
        known = f"rank {self.rank}, condition {self.condition:.2g}, {_number_of(self.evaluations, 'evaluation')}"
        lines += [f"  {_number_of(len(self.estimates), 'free parameter')}, {known}", *_parameters(self)]
        return "\n".join([*lines, *(f"  note: {note}" for note in self.notes)])


def _in_units(name: str, metres: Any) -> dict[str, Any]:
    """Lengths in metres and in millimetres; None of what is not there."""
    return {f"{name}_m": metres, f"{name}_mm": None if metres is None else metres * MILLIMETRES}


def _figures(deviation: Deviation, chord: float) -> dict[str, Any]:
    units = {"m": 1.0, "mm": MILLIMETRES, "of_chord": 1.0 / chord}
    return {"count": deviation.count} | {
        unit: {name: getattr(deviation, name) * scale for name in FIGURES} for unit, scale in units.items()
    }


def _worst(fit: Fit) -> dict[str, Any] | None:
    """The inlier that is farthest off."""
    if not np.any(fit.inliers):
        return None
    i = fit.worst
    return {
        "index": i,
        "point_m": fit.cloud[i],
        "region": fit.regions[i],
        "place": fit.places[i],
        "u": fit.u[i],
        "v": fit.v[i],
        **_in_units("deviation", fit.deviations[i]),
    }


def plain(value: Any) -> Any:
    """Numbers, arrays, sequences and dictionaries as JSON has them; None for what is not finite."""
    if isinstance(value, np.ndarray | np.generic):
        return plain(value.tolist())
    if isinstance(value, dict):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _table(fit: Fit) -> list[str]:
    """Deviations of the inliers, a row for each region."""
    rows = [[f"deviation [{unit_of_lengths(fit.design)}]", "points", "mean", "rms", "99 %", "max", "max of chord"]]
    for name, of in {"all inliers": fit.deviation, **{name: fit.by_region.get(name) for name in REGIONS}}.items():
        if of is not None and of.count:
            figures = [in_unit(fit.design, getattr(of, figure)) for figure in FIGURES]
            rows.append([name, str(of.count), *figures, f"{of.maximum / fit.chord:.1e}"])
        elif name != "ends":
            # sections have no ends, but a cloud without points on an edge says nothing about it
            rows.append([name, "none", *"-----"])
    first, *widths = (max(map(len, column)) for column in zip(*rows, strict=True))
    return [
        "  ".join([f"  {name:<{first}}", *(f"{cell:>{width}}" for cell, width in zip(cells, widths, strict=True))])
        for name, *cells in rows
    ]


def _parameters(fit: Fit) -> list[str]:
    """A line for each parameter, or for each that the reader must look at where there are many."""
    doubtful = [each for each in fit.estimates if not each.identified or each.at_bound]
    shown = list(fit.estimates) if len(fit.estimates) <= FEW_PARAMETERS else doubtful
    width = max((len(each.path) for each in shown), default=0)
    lines = []
    for each in shown:
        marks = ["NOT IDENTIFIED"] * (not each.identified) + ["AT BOUND"] * each.at_bound
        half, value, spread = (each.high - each.low) / 2.0, f"{each.value:.6g}", ""
        if each.identified and math.isfinite(half) and half > 0.0:
            # to the digits that are known
            decimals = min(max(1 - math.floor(math.log10(half)), 0), 12)
            value, spread = f"{each.value:.{decimals}f}", f"+- {half:.2g}"
        unit = unit_of_parameter(fit.design, each.path)
        lines.append(f"    {each.path:<{width}}  {value:>12}  {spread:<12}  {unit:<4} {', '.join(marks)}".rstrip())
    rest = len(fit.estimates) - len(shown)
    if rest:
        lines.append(f"    {'the others' if shown else 'all'} ({rest}) are identified and inside their bounds")
    return lines


def _number_of(count: int, what: str) -> str:
    return f"{count} {what}{'' if count == 1 else 's'}"


def unit_of_lengths(design: Design) -> str:
    """The design's unit of length."""
    return str(design.length_unit)  # type: ignore[attr-defined]


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
