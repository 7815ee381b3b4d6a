"""A design from a table of stations: every column of the table becomes a law that meets its values.

The design is of the curvature-meanline family with the modified NACA thickness, whose parameters follow from metal
angles, stagger, maximum thickness, its place and both edge radii in closed form. What the table does not say is
assumed, and every assumption is stated in a comment beside its key.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from bladewright.blade.design.families import CurvatureMeanlineBlade
from bladewright.blade.design.flow_path import FlowPath
from bladewright.blade.design.stacking import Stacking
from bladewright.designs import Law, Stations
from bladewright.errors import DesignError, FileError
from bladewright.files.given_table import GivenTable, read_given_table
from bladewright.files.table_formulas import other_point, parabolic_rear, share_of, stagger_of
from bladewright.files.table_walls import edge_lines, straight_walls
from bladewright.files.writing import text_of
from bladewright.nurbs.basis import Reals
from bladewright.section.curvature_meanline import CurvatureMeanline
from bladewright.section.thickness.modified_naca import RADIUS, ModifiedNaca

SOLIDITY = 1.2
"""Chord over pitch at mid-span from which the number of blades is assumed: that of a usual axial row [-]"""
THICKNESS, PLACE = 0.08, 0.4
"""Maximum thickness and its place where the table gives none, of the chord: those of a usual compressor blade [-]"""
TRAILING_RADIUS = 0.1
"""Radius of the trailing edge where the table gives none, of the maximum thickness [-]"""
SAME_CHORD = 0.01
"""Difference up to which a chord beside edges is that of the edges: a mean radius may be taken in another way [-]"""
SAME_ANGLE = 1e-6
"""Camber below which a stagger other than the metal angles has no meanline [deg]"""


@dataclass(frozen=True, kw_only=True)
class TableDesign:
    """What a table of stations makes."""

    design: CurvatureMeanlineBlade
    remarks: Mapping[str, str]
    """what was assumed, or computed, by the key that it is about"""

    @property
    def text(self) -> str:
        """The design file, each remark in a comment before its key."""
        lines, table = [], ""
        for line in text_of(self.design).splitlines():
            match = re.match(r"\[([\w.]+)\]$|(\w+) = ", line)
            table = match[1] if match and match[1] else table
            key = "" if match is None else match[1] or ".".join(filter(None, (table, match[2])))
            lines += [f"# {self.remarks[key]}", line] if key in self.remarks else [line]
        return "\n".join(lines) + "\n"


def design_from_table(path: Path, changes: Mapping[str, Any] | None = None) -> TableDesign:
    """The design that meets the values of a CSV file's table at its stations, with changes by path.

    Raises FileError where the table does not say enough, and DesignError where its blade cannot be built.
    """
    made = _Translation(read_given_table(path), re.sub(r'[/\\:*?"<>|\s]+', "-", path.stem) or "blade").result()
    try:
        design = made.design.changed(changes or {})
        design.exact_blade().check()
    except DesignError as error:
        raise DesignError(f"'{path}' makes a blade that cannot be built: {error}") from error
    stated = {key: words for key, words in made.remarks.items() if not any(_is_in(each, key) for each in changes or {})}
    return TableDesign(design=design, remarks=stated)


def _is_in(path: str, key: str) -> bool:
    """Whether a path leads to a key or into it."""
    return path == key or path.startswith((f"{key}.", f"{key}["))


class _Translation:
    """A table on its way to a design."""

    def __init__(self, table: GivenTable, name: str) -> None:
        self.table, self.columns, self.name = table, dict(table.columns), name
        self.where = f"'{table.where}'"
        self.remarks: dict[str, str] = {}
        for each in ("metal_angle_in", "metal_angle_out"):
            if each not in self.columns:
                raise FileError(f"{self.where} has no column {each}: give it, such as {each} [deg]")
        self.count = len(self.columns["metal_angle_in"])
        self.inlet, self.middle, self.outlet = self._places()

    def result(self) -> TableDesign:
        stagger = self._stagger()
        if self.table.results:
            self.remarks["section"] = f"results in the table are left out: {', '.join(self.table.results)}"
        chord, placed = self._placed(stagger)
        blades = self._blade_count(chord)
        section = CurvatureMeanline(
            metal_angle_in=self._law("metal_angle_in", self.inlet),
            metal_angle_out=self._law("metal_angle_out", self.outlet),
            curvature=self._curvature(),
            thickness=self._thickness(chord),
        )
        moved: dict[str, Any] = {
            each: self._law(each, self.middle) for each in ("lean", "sweep") if each in self.columns
        }
        try:
            design = CurvatureMeanlineBlade(
                name=self.name,
                length_unit=self.table.length_unit,  # type: ignore[arg-type]
                description=f"From the table {Path(self.table.where).name}",
                blade_count=blades,
                section=section,
                **placed,
                **moved,
            )
        except DesignError as error:
            raise FileError(f"{self.where} gives no design: {error}") from error
        return TableDesign(design=design, remarks=self.remarks)

    def _places(self) -> tuple[Reals, Reals, Reals]:
        """Span fractions (n,) of inlet quantities, of the others, and of outlet quantities."""
        columns = self.columns
        if "r" in columns:
            columns.setdefault("r_le", columns["r"])
            columns.setdefault("r_te", columns["r"])
        if "span" in columns:
            span = columns["span"]
            self._check_rising("span", span)
            if span[0] != 0.0 or span[-1] != 1.0:
                raise FileError(
                    f"{self.where}: span runs from {span[0]:g} to {span[-1]:g}; the first row must be the hub, 0, and "
                    "the last the shroud, 1: add rows there"
                )
            return span, span, span
        if not {"r_le", "r_te"} <= columns.keys():
            raise FileError(
                f"{self.where} does not say where its rows stand: give a column span, from 0 at the hub to 1 at the "
                "shroud, or r [mm], or r_le [mm] and r_te [mm]"
            )
        for each in ("r_le", "r_te"):
            self._check_rising("r" if "r" in columns else each, columns[each])
        inlet, outlet = columns["r_le"], columns["r_te"]
        return _fractions(inlet), _fractions(0.5 * (inlet + outlet)), _fractions(outlet)

    def _check_rising(self, name: str, values: Reals) -> None:
        falls = np.flatnonzero(np.diff(values) <= 0.0)
        if len(falls):
            i = int(falls[0]) + 1
            cure = "sort the rows" if name == "span" else "sort the rows, or give a column span in the place of radii"
            raise FileError(
                f"{self.where}: {name} is {values[i]:g} in row {i + 1} after {values[i - 1]:g}: it must rise from hub "
                f"to shroud; {cure}"
            )

    def _law(self, name: str, places: Reals, values: Reals | None = None) -> Law:
        """The law through the values of a column, or through others."""
        found = (self.columns[name] if values is None else values).tolist()
        return found[0] if len(set(found)) == 1 else Stations(span=tuple(places.tolist()), values=tuple(found))

    def _stagger(self) -> Reals:
        """Stagger (n,) [deg]: given, or the mean of the metal angles."""
        columns = self.columns
        return columns.get("stagger", 0.5 * (columns["metal_angle_in"] + columns["metal_angle_out"]))

    def _curvature(self) -> tuple[Law, ...]:
        """Control points of the meanline's second derivative: equal ones, or those that give the stagger.

        With I the integral of the second derivative S and J that of (1 - u) S, the slopes at the edges are as -J to
        I - J. Two of three control points are equal, and the one ahead of them, or behind them, is 1.
        """
        if "stagger" not in self.columns:
            self.remarks["section.curvature"] = (
                "assumed: an even second derivative, so that the stagger is the mean of the metal angles; only ratios "
                "count"
            )
            return (1.0, 1.0)
        angles = [self.columns[each] - self.columns["stagger"] for each in ("metal_angle_in", "metal_angle_out")]
        first, last = (np.tan(np.radians(each)) for each in angles)
        straight = np.abs(first - last) < np.radians(SAME_ANGLE)
        shares = np.where(straight, 0.5, first / np.where(straight, 1.0, first - last))
        shares = np.where(straight & (np.abs(first) > np.radians(SAME_ANGLE)), np.inf, shares)
        most = share_of((1.0, 0.0, 0.0))
        for i in np.flatnonzero(~(np.abs(shares - 0.5) <= most - 0.5)):
            inlet, outlet = self.columns["metal_angle_in"][i], self.columns["metal_angle_out"][i]
            low, high = sorted(stagger_of(inlet, outlet, each) for each in (1.0 - most, most))
            raise FileError(
                f"{self.where}: stagger is {self.columns['stagger'][i]:g} deg in row {i + 1}, between metal angles of "
                f"{inlet:g} and {outlet:g} deg: a meanline that bends one way all along has a stagger from {low:.4g} "
                f"to {high:.4g} deg; change it, or leave the column out"
            )
        self.remarks["section.curvature"] = "computed: the table's stagger; only ratios count"
        other = [other_point(0.5 + abs(float(share) - 0.5)) for share in shares]
        ahead, behind = (np.where(side, 1.0, other) for side in (shares >= 0.5, shares <= 0.5))
        points = {"front": ahead, "middle": np.array(other), "rear": behind}
        return tuple(self._law(name, self.middle, _rounded(values)) for name, values in points.items())

    def _placed(self, stagger: Reals) -> tuple[Reals, dict[str, Any]]:
        """Chords (n,), and the fields that say where the blade stands."""
        columns, cosine = self.columns, np.cos(np.radians(stagger))
        theta: dict[str, Any] = {"theta": self._law("theta", self.middle)} if "theta" in columns else {}
        if not {"r_le", "r_te"} <= columns.keys():
            raise FileError(f"{self.where} has no radii: give a column r [mm], or r_le [mm] and r_te [mm]")
        given = [each for each in ("chord", "axial_chord") if each in columns]
        edges = {"x_le", "x_te"} <= columns.keys()
        built = "meridional_chord" in self.table.results
        if edges and built and not self._same_chords(given, stagger):
            self.remarks["leading_edge"] = (
                f"{' and '.join(given)} of the table are left out: they are lengths along a curved stream line, and "
                "x and r of the edges say how long the sections are"
            )
        elif not (self._same_chords(given, stagger) if edges else len(given) == 1):
            found = " and ".join([*(["x_le and x_te"] if edges else []), *given]) or "nothing"
            raise FileError(
                f"{self.where} says how long the sections are by {found}: give one of chord [mm], axial_chord [mm], or "
                "x_le [mm] and x_te [mm]"
            )
        ends = [columns["r_le"], columns["r_te"]]
        if edges:
            x = [columns["x_le"], columns["x_te"]]
            chord = np.hypot(x[1] - x[0], ends[1] - ends[0]) / cosine
            lines = edge_lines(x, ends)
            self.remarks["flow_path"] = (
                "assumed: straight hub and shroud through the first and the last row's edges, and on beyond them"
            )
            walls = straight_walls(x, ends, chord)
            position = {"leading_edge_theta": theta["theta"]} if theta else {}
            return chord, {
                "flow_path": FlowPath(hub=walls[0], shroud=walls[1], matched="edges"),
                "leading_edge": lines[0],
                "trailing_edge": lines[1],
                **position,
            }
        chord = columns["chord"] if "chord" in columns else _rounded(columns["axial_chord"] / cosine)
        half = 0.5 * chord * cosine
        level = np.allclose(ends[0], ends[1], rtol=1e-9)
        self.remarks["flow_path"] = (
            "assumed: a straight annulus of the first and the last row's radii"
            if level
            else "assumed: straight hub and shroud of the first and the last row's radii at both edges"
        )
        self.remarks["stacking"] = "assumed: sections stacked by their centroids on the radial line x = 0"
        walls = straight_walls([-half, half], ends, chord)
        stacking = Stacking(reference="centroid", chord=self._law("chord", self.middle, chord), hub_x=0.0, **theta)
        return chord, {"flow_path": FlowPath(hub=walls[0], shroud=walls[1]), "stacking": stacking}

    def _same_chords(self, given: Sequence[str], stagger: Reals) -> bool:
        """Whether chords that a table has beside its edges are those of the edges."""
        columns = self.columns
        along = np.hypot(columns["x_te"] - columns["x_le"], columns["r_te"] - columns["r_le"])
        own = {"chord": along / np.cos(np.radians(stagger)), "axial_chord": columns["x_te"] - columns["x_le"]}
        return all(np.allclose(columns[each], own[each], rtol=SAME_CHORD) for each in given)

    def _blade_count(self, chord: Reals) -> int:
        middle = self.count // 2
        radius = 0.5 * (self.columns["r_le"][middle] + self.columns["r_te"][middle])
        given = self.columns.get("solidity")
        solidity = SOLIDITY if given is None else given[middle]
        count = max(2, round(float(solidity * 2.0 * np.pi * radius / chord[middle])))
        whose = f"assumed: a solidity of about {SOLIDITY:g}" if given is None else "computed: the table's solidity"
        self.remarks["blade_count"] = f"{whose} in the middle row"
        return count

    def _of_chord(self, name: str, chord: Reals) -> Reals | None:
        """A column as fractions of the chord; None where the table does not have it."""
        if name not in self.columns:
            return None
        return self.columns[name] if name in self.table.of_chord else _rounded(self.columns[name] / chord)

    def _thickness(self, chord: Reals) -> ModifiedNaca:
        """The modified NACA thickness of the table's maximum, its place, and edge radii."""
        most, leading, trailing = (
            self._of_chord(each, chord) for each in ("maximum_thickness", "leading_edge_radius", "trailing_edge_radius")
        )
        place, path = self.columns.get("maximum_thickness_at"), "section.thickness"
        # thicknesses are laid off along the chord, and normal to the camber line, which leaves it at these angles
        ahead, behind = (
            1.0 / np.cos(np.radians(self.columns[each] - self._stagger()))
            for each in ("metal_angle_in", "metal_angle_out")
        )
        if most is None:
            most = np.full(self.count, THICKNESS)
            self.remarks[f"{path}.maximum_thickness"] = "assumed"
        if place is None:
            place = np.full(self.count, PLACE)
            self.remarks[f"{path}.maximum_thickness_at"] = "assumed"
        if trailing is None:
            trailing = TRAILING_RADIUS * most / behind
            self.remarks[f"{path}.trailing_edge_thickness"] = (
                f"assumed: a radius of {TRAILING_RADIUS:g} of the maximum thickness"
            )
        else:
            self.remarks[f"{path}.trailing_edge_thickness"] = (
                "computed: where the round edge of the table's trailing_edge_radius begins"
            )
        slope, begins = parabolic_rear(most, place, trailing * behind)
        self.remarks[f"{path}.trailing_edge_slope"] = (
            "assumed: the half thickness is a parabola from its maximum to the trailing edge's circle"
        )
        fields: dict[str, Law] = {}
        if leading is not None:
            index = _rounded(6.0 * np.sqrt(2.0 * leading * ahead / RADIUS) / most)
            fields["leading_edge_index"] = self._law("index", self.inlet, index)
            self.remarks[f"{path}.leading_edge_index"] = (
                "computed: the table's radius, 1.1019 (maximum_thickness index / 6)^2 cos(camber angle from the chord)"
            )
        if not np.allclose(self.columns["r_le"], self.columns["r_te"], rtol=1e-9):
            self.remarks[path] = (
                "in the plane (m', theta): where the radius changes along the chord, so do thicknesses and edge radii"
            )
        try:
            return ModifiedNaca(
                maximum_thickness=self._law("maximum_thickness", self.middle, most),
                maximum_thickness_at=self._law("maximum_thickness_at", self.middle, place),
                trailing_edge_thickness=self._law("thickness", self.outlet, _rounded(begins)),
                trailing_edge_slope=self._law("slope", self.outlet, _rounded(slope)),
                **fields,  # type: ignore[arg-type]
            )
        except DesignError as error:
            raise FileError(f"{self.where} gives no section: {error}") from error


def _fractions(r: Reals) -> Reals:
    return _rounded((r - r[0]) / (r[-1] - r[0]))


def _rounded(values: Reals) -> Reals:
    """Values to 14 digits, so that a file shows 0.08 for 4 mm in 50."""
    return np.array([float(f"{value:.14g}") for value in values])
