"""The station table: what is built, at places along the span, as quantities with names and units."""

from __future__ import annotations

import csv
import io
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import Any, ClassVar

import numpy as np

from bladewright.atomic_write import atomic_write
from bladewright.designs import unknown
from bladewright.display import Shown
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, degrees
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import UNITS

COLUMNS: Mapping[str, str] = MappingProxyType(
    {
        "span": "-",
        "leading_edge_x": "length",
        "leading_edge_r": "length",
        "trailing_edge_x": "length",
        "trailing_edge_r": "length",
        "metal_angle_in": "deg",
        "metal_angle_out": "deg",
        "turning": "deg",
        "stagger": "deg",
        "chord": "length",
        "meridional_chord": "length",
        "axial_chord": "length",
        "maximum_thickness": "length",
        "thickness_to_chord": "-",
        "maximum_thickness_at": "-",
        "leading_edge_radius": "length",
        "leading_edge_thickness": "length",
        "trailing_edge_radius": "length",
        "trailing_edge_thickness": "length",
        "pitch_in": "length",
        "pitch_mid": "length",
        "pitch_out": "length",
        "pitch_to_chord": "-",
        "solidity": "-",
        "throat": "length",
        "throat_to_pitch": "-",
        "gauge_angle": "deg",
        "blockage": "-",
        "lean": "deg",
        "leading_edge_sweep": "deg",
        "trailing_edge_sweep": "deg",
        "trailing_edge_lean": "deg",
        "wrap": "deg",
    }
)
"""Quantities of a station by name, with their units; `docs/nomenclature.md` defines them."""
IN_SPACE = frozenset({"leading_edge_r", "trailing_edge_r", "meridional_chord", "lean"})
IN_SPACE |= {"leading_edge_sweep", "trailing_edge_sweep", "trailing_edge_lean"}
"""Those that a section in a plane has not."""
IN_A_ROW = frozenset({"pitch_in", "pitch_mid", "pitch_out", "pitch_to_chord", "solidity", "blockage"})
"""Those that need a neighbour."""
OF_THE_THROAT = frozenset({"throat", "throat_to_pitch", "gauge_angle"})
"""Those of the gap to the neighbour."""
DIGITS = 6
"""Significant digits of a number in the text."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class StationTable(Shown, ABC):
    """What is built, at stations along the span, measured and not taken from the laws of the design.

    Each quantity of `names` is an attribute, also `table["solidity"]`: an array (m,), one entry a station, in metres
    and radians, computed when it is first asked for, and complex where the build carries a step. `to_dict`, `to_csv`
    and `str` give them in the design's unit of length and degrees.
    """

    shown_as: ClassVar[str] = "stations"

    name: str
    """the design's name"""
    length_unit: str
    """unit of the lengths in text, CSV and dictionary"""
    span: Reals
    """(m,) places along the span, 0 at the hub and 1 at the shroud"""
    annular: bool
    """whether blades stand around the machine axis"""

    @property
    @abstractmethod
    def metal_angle_in(self) -> Array:
        """Angle of the camber line at the leading edge, on the stream surface [rad]."""

    @property
    @abstractmethod
    def metal_angle_out(self) -> Array:
        """The same at the trailing edge [rad]."""

    @property
    @abstractmethod
    def chord(self) -> Array:
        """Distance along the stream surface from the leading to the trailing edge [m]."""

    @property
    @abstractmethod
    def maximum_thickness(self) -> Array:
        """Diameter of the largest circle inside the section [m]."""

    @property
    @abstractmethod
    def pitch_mid(self) -> Array:
        """Pitch at mid-chord [m]."""

    @property
    @abstractmethod
    def throat(self) -> Array:
        """Smallest distance to the neighbouring blade [m]."""

    @property
    @abstractmethod
    def _throat_pitch(self) -> Array:
        """Pitch at the edge that the throat is nearer to [m]."""

    @property
    @abstractmethod
    def edge_kinds(self) -> tuple[str, str]:
        """How the sides meet at the leading and at the trailing edge: "round", "sharp" or "blunt"."""

    @property
    @abstractmethod
    def in_space(self) -> bool:
        """Whether the sections lie on stream surfaces, not in one plane."""

    @property
    @abstractmethod
    def in_a_row(self) -> bool:
        """Whether there is a neighbour."""

    @property
    def turning(self) -> Array:
        """Turning of the camber line: `metal_angle_in` less `metal_angle_out` [rad]."""
        return self.metal_angle_in - self.metal_angle_out

    @property
    def thickness_to_chord(self) -> Array:
        """Maximum thickness over chord [-]."""
        return self.maximum_thickness / self.chord

    @property
    def pitch_to_chord(self) -> Array:
        """Pitch at mid-chord over chord [-]."""
        return self.pitch_mid / self.chord

    @property
    def solidity(self) -> Array:
        """Chord over pitch at mid-chord [-]."""
        return self.chord / self.pitch_mid

    @property
    def throat_to_pitch(self) -> Array:
        """Throat over the pitch at the edge that it is nearer to [-]."""
        return self.throat / self._throat_pitch

    @property
    def gauge_angle(self) -> Array:
        """arccos of throat over pitch [rad]: the angle from the meridional direction of flow that fills the throat."""
        share = self.throat_to_pitch
        return np.arctan(np.sqrt(1.0 - share**2) / share)

    @property
    def scalars(self) -> Mapping[str, tuple[str, Array]]:
        """Quantities of the whole blade by name, each with its unit."""
        return {}

    @property
    def remarks(self) -> tuple[str, ...]:
        """What is said of the whole, a sentence each."""
        return ()

    def __getitem__(self, name: str) -> Array:
        """A quantity (m,) by name, in metres and radians."""
        if name not in COLUMNS:
            raise DesignError(unknown(f"the column '{name}'", name, list(COLUMNS)))
        found: Array = getattr(self, name)
        return found

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The quantities that there are of this blade: no radius of a blunt edge, no throat of a single blade."""
        without = set[str]() if self.in_space else set(IN_SPACE)
        without |= set() if self.in_a_row else IN_A_ROW
        without |= set() if self._has_throat else OF_THE_THROAT
        for edge, kind in zip(("leading_edge", "trailing_edge"), self.edge_kinds, strict=True):
            without.add(f"{edge}_radius" if kind == "blunt" else f"{edge}_thickness")
        return tuple(name for name in COLUMNS if name not in without)

    @cached_property
    def _has_throat(self) -> bool:
        try:
            return self.in_a_row and len(self.throat) > 0
        except DesignError:
            return False

    def heading(self, name: str) -> tuple[str, str]:
        """Name and unit of a column: z and y where r and theta are those of a cascade."""
        unit = COLUMNS[name]
        if not self.annular:
            name = name.removesuffix("_r") + "_z" if name.endswith("_r") else name
            unit = "length" if name == "wrap" else unit
        return name, self.length_unit if unit == "length" else unit

    def values(self, name: str) -> Reals:
        """A column (m,), real, in the unit of its heading."""
        return self._in_units(self[name], self.heading(name)[1])

    def _in_units(self, value: Array, unit: str) -> Reals:
        real = np.real(value)
        if unit == "deg":
            return np.asarray(degrees(real))
        name = unit.removesuffix("2")
        return np.asarray(real / UNITS[name] ** (2 if name != unit else 1) if name in UNITS else real)

    def to_dict(self) -> dict[str, Any]:
        """Columns with their units, lengths in the design's unit and angles in degrees, for JSON."""
        columns = [(self.heading(name), self.values(name)) for name in self.names]
        return {
            "units": {name: unit for (name, unit), _ in columns},
            "stations": {name: values.tolist() for (name, _), values in columns},
            **{name: float(self._in_units(value, unit)) for name, (unit, value) in self.scalars.items()},
        }

    def to_csv(self, path: str | Path | None = None) -> str:
        """One line a station under a line of names with units, as text; written to `path` where one is given.

        Raises FileError where the file cannot be written.
        """
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        headings = [self.heading(name) for name in self.names]
        writer.writerow([name if unit == "-" else f"{name} [{unit}]" for name, unit in headings])
        writer.writerows(zip(*[[repr(float(v)) for v in self.values(name)] for name in self.names], strict=True))
        if path is not None:
            with atomic_write(path) as unfinished:
                Path(unfinished).write_text(text.getvalue(), encoding="utf-8")
        return text.getvalue()

    def __str__(self) -> str:
        """Quantities as rows and stations as columns."""
        rows = []
        for name in self.names:
            words, unit = self.heading(name)
            rows.append([words.replace("_", " "), unit, *(_figure(value) for value in self.values(name))])
        for words, (unit, value) in self.scalars.items():
            rows.append([words.replace("_", " "), unit, _figure(float(self._in_units(value, unit)))])
        return "\n".join([*_aligned(rows), *self.remarks])

    def __repr__(self) -> str:
        """One line."""
        count = len(self.span)
        return f"<{type(self).__name__} of {self.name}: {len(self.names)} quantities at {count} stations>"


def _figure(value: float) -> str:
    if not np.isfinite(value):
        return "flat"
    rounded = 0.0 if value * value < 1e-18 else value
    return f"{rounded:.{DIGITS}g}"


def _aligned(rows: Sequence[Sequence[str]]) -> list[str]:
    width = max(len(row[0]) for row in rows)
    units = max(len(row[1]) for row in rows)
    figures = max(len(each) for row in rows for each in row[2:])
    return [
        f"  {row[0]:<{width}}  {row[1]:<{units}}" + "".join(f"  {each:>{figures}}" for each in row[2:]) for row in rows
    ]


def checked_stations(stations: Any) -> Reals:
    """Places along the span (m,) as an array; DesignError where there are none, or one is outside [0, 1]."""
    try:
        found = np.atleast_1d(np.asarray(stations, dtype=np.float64))
    except (TypeError, ValueError):
        found = np.empty((0, 0))
    if found.ndim != 1 or len(found) == 0:
        raise DesignError(f"stations are {stations!r}: give span fractions, such as [0, 0.25, 0.5, 0.75, 1]")
    outside = found[~((found >= 0.0) & (found <= 1.0))]
    if len(outside):
        raise DesignError(
            f"a station is {outside[0]:g}: stations are span fractions, from 0 at the hub to 1 at the shroud"
        )
    return found
