"""The report of a round trip: a CAD file measured against the surfaces it came from."""

from dataclasses import dataclass
from typing import Any, ClassVar

from bladewright import __version__
from bladewright.cad.kernel_check import KernelFault
from bladewright.cad.native_body import NamedBody
from bladewright.display import Shown
from bladewright.domain.row import of_every_blade
from bladewright.numerics.elementary import Array
from bladewright.origin import Origin
from bladewright.section.checks import UNITS

LEAST_TOLERANCE = 1e-7
"""Smallest tolerance of OpenCASCADE [mm]: its check calls a curve that is further off its surface invalid."""


def conformance_figures(body: NamedBody) -> dict[str, float] | None:
    """How a blade's surfaces conform to its design (`Blade.conformance`); None for a body that does not state it."""
    conformance: Any = getattr(body, "conformance", None)
    return None if conformance is None else conformance.to_dict()


@dataclass(frozen=True, kw_only=True, eq=False)
class Comparison:
    """A quantity of the CAD file beside that of the native surfaces."""

    cad: float
    native: float

    @property
    def relative_error(self) -> float:
        """|cad - native| / |native|."""
        return abs(self.cad - self.native) / max(abs(self.native), 1e-300)

    def to_dict(self) -> dict[str, float]:
        """As in the round-trip report."""
        return {"cad": self.cad, "native": self.native, "relative_error": self.relative_error}


@dataclass(frozen=True, kw_only=True, eq=False)
class FaceReport:
    """The measurement of one face, from the native face to the file and back."""

    name: str
    samples: int
    pieces: int
    """faces of the file that it is in"""
    max_deviation: float
    """[mm]"""
    mean_deviation: float
    """[mm]"""
    worst: tuple[float, float]
    """native u and v where the deviation is largest"""
    area: Comparison
    """[mm^2]"""

    def to_dict(self) -> dict[str, Any]:
        """As in the round-trip report."""
        return {
            "name": self.name,
            "samples": self.samples,
            "pieces": self.pieces,
            "max_deviation_mm": self.max_deviation,
            "mean_deviation_mm": self.mean_deviation,
            "worst": {"u": self.worst[0], "v": self.worst[1]},
            "area_mm2": self.area.to_dict(),
        }


@dataclass(frozen=True, kw_only=True, eq=False)
class EdgeReport:
    """The measurement of all edges."""

    count: int
    shortest: float
    """[mm]"""
    max_gap: float
    """[mm] largest distance between the faces at an edge, or from the edge's own curve, at equal parameters"""
    max_tolerance: float
    """[mm] largest tolerance of edges and vertices"""

    def to_dict(self) -> dict[str, Any]:
        """As in the round-trip report."""
        return {
            "count": self.count,
            "shortest_mm": self.shortest,
            "max_gap_mm": self.max_gap,
            "max_tolerance_mm": self.max_tolerance,
        }


@dataclass(frozen=True, kw_only=True, eq=False)
class PlacementReport:
    """The measurement of one blade of a row."""

    name: str
    displacement: float
    """[mm] largest distance of a point of the blade's box from where the placement puts it"""

    def to_dict(self) -> dict[str, Any]:
        """As in the round-trip report."""
        return {"name": self.name, "displacement_mm": self.displacement}


@dataclass(frozen=True, kw_only=True, eq=False)
class RoundTrip(Shown):
    """A CAD file measured against a body; `failures` says what misses a limit, where and by how much.

    Of a row faces and edges are those of its one part, and volume, area and centroid those of all blades together.
    """

    shown_as: ClassVar[str] = "round trip"

    file: str
    format: str
    schema: str
    unit: str
    failures: tuple[str, ...]
    limits: dict[str, float]
    solids: int
    shells: int
    free_edges: int
    valid: bool
    faces: tuple[FaceReport, ...]
    edges: EdgeReport
    volume: Comparison
    """[mm^3]"""
    default_volume: Comparison | None
    """[mm^3] of the file by OpenCASCADE's default quadrature, as FreeCAD and CadQuery show it; none of triangles"""
    kernel_faults: tuple[KernelFault, ...] | None
    """what OpenCASCADE's own check finds, which does not count for `passed`; none of triangles"""
    area: Comparison
    """[mm^2]"""
    centroid: tuple[Array, Array]
    """(3,) [mm] in the file, and native"""
    promises: dict[str, float] | None = None
    """how the native surfaces themselves conform to the design, where the body states it"""
    origin: Origin | None = None
    """the design that the file was made from, where it is known"""
    placements: tuple[PlacementReport, ...] = ()
    """of the blades of a row"""

    @property
    def passed(self) -> bool:
        """Whether every figure is within its limit, and the file holds one closed, valid solid with every face."""
        return not self.failures

    @property
    def centroid_distance(self) -> float:
        """Distance of the centroids [mm]."""
        return float(sum((a - b) ** 2 for a, b in zip(*self.centroid, strict=True)) ** 0.5)

    def to_dict(self) -> dict[str, Any]:
        """The report as plain numbers, strings, lists and dictionaries, ready for JSON."""
        volume: dict[str, Any] = dict(self.volume.to_dict())
        if self.default_volume is not None:
            shown = self.default_volume
            volume["kernel_default"] = {"cad": shown.cad, "relative_error": shown.relative_error}
        faults = None if self.kernel_faults is None else [fault.to_dict() for fault in self.kernel_faults]
        report: dict[str, Any] = {
            "file": self.file,
            "format": self.format,
            "schema": self.schema,
            "unit": self.unit,
            "passed": self.passed,
            "failures": list(self.failures),
            "limits": dict(self.limits),
            "solids": self.solids,
            "shells": self.shells,
            "free_edges": self.free_edges,
            "valid": self.valid,
            "kernel_check": faults,
            "faces": [face.to_dict() for face in self.faces],
            "edges": self.edges.to_dict(),
            "volume_mm3": volume,
            "area_mm2": self.area.to_dict(),
            "centroid_mm": {
                "cad": [float(x) for x in self.centroid[0]],
                "native": [float(x) for x in self.centroid[1]],
                "distance": self.centroid_distance,
            },
        }
        report["version"] = __version__
        report["design"] = None if self.origin is None else self.origin.to_dict()
        if self.placements:
            report["placements"] = [each.to_dict() for each in self.placements]
        if self.promises is not None:
            report["promises"] = self.promises
        return report

    def __repr__(self) -> str:
        verdict = "passed" if self.passed else f"FAILED ({len(self.failures)})"
        size = f"volume {self.volume.cad:.6g} mm3 ({self.volume.relative_error:.1e} off)"
        return f"<RoundTrip '{self.file}' ({self.format}): {verdict}; {len(self.faces)} faces, {size}>"

    def __str__(self) -> str:
        return self.text(self.unit if self.unit in UNITS else "mm")

    def text(self, unit: str) -> str:
        """The report to read, with lengths in `unit` (of `section.checks.UNITS`); limits are in mm."""
        kind = " ".join(word for word in (self.format, self.schema) if word)
        valid = "valid" if self.valid else "invalid"
        volume, area, edges = self.volume, self.area, self.edges
        length = 1e-3 / UNITS[unit]
        lines = [f"{self.file} ({kind}, {self.unit}): {'passed' if self.passed else 'FAILED'}"]
        lines += [f"  - {failure}" for failure in self.failures]
        solids, shells = (f"{n} {word}{'s' * (n != 1)}" for n, word in ((self.solids, "solid"), (self.shells, "shell")))
        lines.append(f"  {solids}, {shells}, {self.free_edges} free edges, {valid}")
        if self.placements:
            worst = max(self.placements, key=lambda each: each.displacement)
            away = f"{worst.displacement * length:.1e} {unit} off, {worst.name}"
            lines.append(f"  placements: {len(self.placements)}, at most {away}")
        groups: dict[str, list[FaceReport]] = {}
        for face in self.faces:
            groups.setdefault(of_every_blade(face.name), []).append(face)
        width = max((len(name) for name in groups), default=0)
        for name, alike in groups.items():
            face = max(alike, key=lambda each: each.max_deviation)
            away = (
                f"deviation {face.max_deviation * length:.1e} {unit} (mean {face.mean_deviation * length:.1e} {unit})"
            )
            area_off = max(each.area.relative_error for each in alike)
            size = f"area {face.area.cad * length**2:.6g} {unit}2 ({area_off:.1e} off)"
            pieces = f", in {face.pieces} pieces" if face.pieces > 1 else ""
            count = f", the worst of {len(alike)}" if len(alike) > 1 else ""
            lines.append(f"  {name:<{width}}  {away}, {size}{pieces}{count}")
        lines.append(
            f"  edges: {edges.count}, gap {edges.max_gap * length:.1e} {unit}, "
            f"tolerance {edges.max_tolerance * length:.1e} {unit}"
        )
        lines.append(
            f"  volume {volume.cad * length**3:.8g} {unit}3 ({volume.relative_error:.1e} off), "
            f"area {area.cad * length**2:.8g} {unit}2 ({area.relative_error:.1e} off), "
            f"centroid {self.centroid_distance * length:.1e} {unit} off"
        )
        if self.default_volume is not None:
            shown = self.default_volume
            size = f"{shown.cad * length**3:.8g} {unit}3 ({shown.relative_error:.1e} off)"
            lines.append(f"  FreeCAD and CadQuery show a volume of {size}")
        if self.kernel_faults is not None:
            found = ", ".join(f"{each.fault} ({each.count})" for each in self.kernel_faults)
            cure = ": build --fine closes gaps to 1e-7 mm" if found and edges.max_gap > LEAST_TOLERANCE else ""
            lines.append(f"  FreeCAD's check of the geometry finds {found or 'nothing'}{cure}")
        return "\n".join(lines)
