"""A CAD file, whoever wrote it, measured against the native surfaces of a blade or passage."""

import os
from pathlib import Path

import numpy as np
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps

from bladewright.cad.closure import Closure, closure
from bladewright.cad.default_quadrature import default_volume
from bladewright.cad.deviation import deviation, native_face
from bladewright.cad.face_pieces import whole_name
from bladewright.cad.file_face import FileFace, file_face
from bladewright.cad.kernel import quiet
from bladewright.cad.kernel_check import kernel_faults
from bladewright.cad.mesh_verification import verify_mesh
from bladewright.cad.native_body import MM, NativeBody, extent
from bladewright.cad.placement import check_row_format, row_and_part
from bladewright.cad.reading import CadFile, format_of, read_cad_file
from bladewright.cad.round_trip import Comparison, EdgeReport, FaceReport, RoundTrip, conformance_figures
from bladewright.cad.row_verification import row_trip
from bladewright.domain.row import Row
from bladewright.numerics.elementary import Array, length
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface

SAMPLES = 10_000
"""Points on each face, native and of the file, at which distances are measured: a grid of 100 x 100 on an untrimmed
face, spaced as its control points are, so that no displaced one is missed."""
SAME_FACE = 0.01
"""Largest displacement of a control point, as a fraction of the body's extent, at which a face without a name is taken
for the nearest native face with the same knots. Generous, so that a face with a defect is reported under its name."""
QUADRATURE = (1e-3, 1e-4, 1e-6, 1e-7, 1e-9, 1e-12)
"""Relative errors of OpenCASCADE's volume quadrature, tried in turn (design/cad_quadrature.py). Blades need the first;
wheels the second or third, which take 2 and 7 s for the 139 faces of Rotor 67's, where the fourth takes 14 s."""
SAFE_SHARE = 0.2
"""Fraction of a limit: where volume and centroid agree within it, no finer quadrature is tried
(design/cad_quadrature.py)."""
SIDE_LIMIT = 1e-6
"""[mm] Largest deviation of an untrimmed face, and largest gap of an edge between two of them. The control points
return from a STEP file within 7e-12 mm and from an IGES file within 4e-10 mm (150 mm blade, OpenCASCADE 7.9), so that
this is no limit on precision but on errors."""
END_LIMIT = 1e-5
"""[mm] Least limit for the deviation of trimmed faces and the gaps of their edges; larger bodies are allowed
`END_LIMIT_PER_CHORD`."""
END_LIMIT_PER_CHORD = 1e-7
"""The same as a fraction of the chord: as far as the native ends may lie off the walls (docs/nomenclature.md)."""
AREA_LIMIT = 1e-9
"""Largest relative error of the area of an untrimmed face, integrated over the file's poles and over the native
ones."""
DIGITS = 5e-13
"""Rounding of a coordinate in a file, of its size: OpenCASCADE writes 13 digits of those from 1000 mm on, and 5e-10 mm
are 5e-9 of the area of a face 0.1 mm wide."""
VOLUME_LIMIT = 1e-6
"""Largest relative error of the volume, of the total area, and of the area of a trimmed face, which depends on edges
that may be off by the gap; largest displacement of the centroid as a fraction of the body's extent."""


def verify(
    path: str | os.PathLike[str], built: NativeBody | Row, *, samples: int = SAMPLES, intersections: bool = False
) -> RoundTrip:
    """The round trip of a CAD file: what it holds, and how far that lies from a body.

    STEP, IGES and BREP files are measured face by face, whoever wrote them and however their surfaces are parametrised,
    every face of a wheel too: at `samples` points, which on an untrimmed face are as dense as its control points;
    STL and 3MF files triangle by triangle. The round trip says what OpenCASCADE's own check finds; with `intersections`
    that also looks for parts that meet where they should not, which takes seconds. Raises CadError where the file is
    not of the format that its name states.
    """
    path = Path(path)
    row, body = row_and_part(built)
    if format_of(path) in {"STL", "3MF"}:
        if row is not None:
            check_row_format(path, format_of(path))
        return verify_mesh(path, body, samples=samples)
    opened = read_cad_file(path)

    def measured(part: CadFile) -> RoundTrip:
        return _FileComparison(part, body, samples, intersections).report()

    with quiet():
        return measured(opened) if row is None else row_trip(opened, row, measured)


def limits_of(built: NativeBody) -> dict[str, float]:
    """The limits of the round trip: distances in millimetres, relative errors of areas and volume."""
    chords = [_chord(face) for face in built.surfaces.values() if isinstance(face, TrimmedSurface)]
    return {
        "side_mm": SIDE_LIMIT,
        "end_mm": max([END_LIMIT, *(END_LIMIT_PER_CHORD * chord * MM for chord in chords)]),
        "edge_mm": SIDE_LIMIT,
        "face_area": AREA_LIMIT,
        "volume": VOLUME_LIMIT,
    }


def _chord(face: TrimmedSurface) -> float:
    """Distance [m] between the ends of a trimmed face's first boundary curve."""
    ends = face.boundary[0].control_points[[0, -1]]
    start, end = face.surface(ends[:, 0], ends[:, 1])
    return float(np.sqrt(np.sum((end - start) ** 2)))


class _FileComparison:
    """One file measured against one body."""

    def __init__(self, opened: CadFile, built: NativeBody, samples: int, intersections: bool) -> None:
        self.opened, self.built, self.samples, self.intersections = opened, built, samples, intersections
        self.limits = limits_of(built)
        self.native = {name: native_face(face) for name, face in built.surfaces.items()}
        self.returned = [file_face(face) for face in opened.faces]
        known = {k: whole_name(name, self.native) for k, name in opened.names.items()}
        self.named = {k: name for k, name in known.items() if name is not None}
        self.names = self._names()
        self.failures: list[str] = []

    def report(self) -> RoundTrip:
        """The report of the round trip."""
        self._check_names()
        faces = tuple(
            self._face(name, [face for k, face in enumerate(self.returned) if self.names[k] == name])
            for name in self.native
            if name in self.names.values()
        )
        closed = closure(self.opened.shape)
        self._check_closure(closed)
        edges = self._edges(closed)
        properties = self.built.properties
        volume, centroid = self._whole()
        shown = Comparison(cad=default_volume(self.opened.shape), native=volume.native)
        total = Comparison(cad=sum(face.area for face in self.returned), native=float(properties.area) * MM**2)
        self._check_whole(volume, total, centroid)
        return RoundTrip(
            file=self.opened.path.name,
            format=self.opened.format,
            schema=self.opened.schema,
            unit=self.opened.unit,
            failures=tuple(self.failures),
            limits=self.limits,
            solids=closed.solids,
            shells=closed.shells,
            free_edges=closed.free_edges,
            valid=closed.valid,
            faces=faces,
            edges=edges,
            volume=volume,
            default_volume=shown,
            kernel_faults=kernel_faults(self.opened.shape, intersections=self.intersections),
            area=total,
            centroid=centroid,
            promises=conformance_figures(self.built),
            origin=self.opened.origin,
        )

    def _whole(self) -> tuple[Comparison, tuple[Array, Array]]:
        """Volume and centroid of the file and of the native body; the quadrature is refined where they disagree."""
        native = float(self.built.properties.volume) * MM**3, np.asarray(self.built.properties.centroid) * MM
        for bound in QUADRATURE:
            whole = GProp_GProps()
            BRepGProp.VolumeProperties_s(self.opened.shape, whole, bound)
            middle = whole.CentreOfMass()
            centroid = np.array([middle.X(), middle.Y(), middle.Z()])
            volume = Comparison(cad=whole.Mass(), native=native[0])
            distance = float(np.linalg.norm(centroid - native[1])) / (extent(self.built) * MM)
            if max(volume.relative_error, distance) < SAFE_SHARE * self.limits["volume"]:
                break
        return volume, (centroid, native[1])

    def _names(self) -> dict[int, str]:
        """The name of every face of the file: its own, or that of the native face that it lies on."""
        names = dict(self.named)
        near = SAME_FACE * extent(self.built) * MM
        for k, face in enumerate(self.returned):
            if k in names:
                continue
            nearest = near
            for name, native in self.native.items():
                pair = native.same_poles(face.region) if native.may_hold(face.outline, near) else None
                # with the same knots and a displaced control point it is this face, with a defect
                moved = np.inf if pair is None else np.max(np.abs(pair[1].control_points - MM * pair[0].control_points))
                if moved < nearest:
                    names[k], nearest = name, float(moved)
            if k not in names:
                names[k] = self._nearest(face)
        return names

    def _nearest(self, face: FileFace) -> str:
        """The native face that the boundary of a face is nearest to: it tells even where the wrong side is kept."""
        least = {
            name: float(native.projection.least_distance(face.outline).max()) for name, native in self.native.items()
        }
        found, nearest = "", np.inf
        for name in sorted(least, key=least.__getitem__):
            if least[name] >= nearest:
                break
            distance = float(self.native[name].projection.closest(face.outline, 0.0)[1].max())
            if distance < nearest:
                found, nearest = name, distance
        return found

    def _check_names(self) -> None:
        missing = [name for name in self.native if name not in self.names.values()]
        if missing:
            self.failures.append(f"no face of the file is {' or '.join(missing)}")
        if self.opened.format == "STEP" and self.opened.written_by_bladewright:
            unnamed = [self.names[k] for k in range(len(self.returned)) if k not in self.named]
            self.failures += [f"face {name} has no name in the file" for name in unnamed]
            for name in self.native:
                self._check_numbers(name)

    def _check_numbers(self, name: str) -> None:
        """The pieces of a face are numbered along u, and row after row along v."""
        pieces = [(*face.region.low[::-1].tolist(), k) for k, face in enumerate(self.returned) if self.names[k] == name]
        given = [self.opened.names.get(k, "") for *_, k in sorted(pieces)]
        wanted = [f"{name}_{number}" for number in range(1, len(given) + 1)] if len(given) > 1 else given
        if given != wanted:
            self.failures.append(f"the pieces of face {name} are called {given}: in the order of u they are {wanted}")

    def _face(self, name: str, faces: list[FileFace]) -> FaceReport:
        native = self.built.surfaces[name]
        untrimmed = isinstance(native, Surface)
        limit = self.limits["side_mm" if untrimmed else "end_mm"]
        found = deviation(self.native[name], [face.region for face in faces], self.samples, limit)
        compared = Comparison(cad=sum(face.area for face in faces), native=self._area(name) * MM**2)
        trip = FaceReport(
            name=name,
            samples=self.samples,
            pieces=len(faces),
            max_deviation=found.largest,
            mean_deviation=found.mean,
            worst=found.worst,
            area=compared,
        )
        if any(face.inside_out for face in faces):
            self.failures.append(f"face {name} keeps the wrong side of its boundary")
        if not found.largest <= limit:
            self.failures.append(
                f"face {name} is {found.largest:.3g} mm off at u = {found.worst[0]:.4g}, v = {found.worst[1]:.4g}: "
                f"at most {limit:.3g} mm is allowed"
            )
        # the area of a trimmed face depends on its boundary, which may be off by the gap
        allowed = self.limits["face_area" if untrimmed else "volume"]
        if isinstance(native, Surface):
            allowed = max(allowed, rounded_area(native.control_points * MM) / compared.native)
        if not compared.relative_error <= allowed:
            self.failures.append(
                f"face {name} has an area of {compared.cad:.10g} mm2, which is off by {compared.relative_error:.3g}: "
                f"at most {allowed:.3g} is allowed"
            )
        return trip

    def _area(self, name: str) -> float:
        areas = getattr(self.built.properties, "areas", None)
        if areas is not None:
            return float(areas[list(self.built.orientations).index(name)])
        return self.native[name].area

    def _check_closure(self, closed: Closure) -> None:
        for count, what in ((closed.solids, "solid"), (closed.shells, "shell")):
            if count != 1:
                self.failures.append(f"the file holds {count} {what}s: one closed body is one {what}")
        if closed.free_edges:
            self.failures.append(f"{closed.free_edges} edges belong to one face only: the body is open")
        if closed.non_manifold_edges:
            self.failures.append(f"{closed.non_manifold_edges} edges do not belong to two faces that run opposite ways")
        if not closed.valid:
            self.failures.append("OpenCASCADE finds the shape invalid")

    def _edges(self, closed: Closure) -> EdgeReport:
        for edge in closed.edges:
            names = sorted({self.names[k] for k in edge.faces})
            sides = all(isinstance(self.built.surfaces[name], Surface) for name in names)
            limit = self.limits["edge_mm" if sides else "end_mm"]
            where = f"the edge of {' and '.join(names)} ({edge.length:.4g} mm long)"
            if not edge.gap <= limit:
                self.failures.append(f"{where} has a gap of {edge.gap:.3g} mm: at most {limit:.3g} mm is allowed")
            # a vertex between sides is an end of edges on the walls too
            tolerances = ((edge.tolerance, limit, "a"), (edge.vertex_tolerance, self.limits["end_mm"], "a vertex of"))
            self.failures += [
                f"{where} has {what} tolerance of {tolerance:.3g} mm: at most {allowed:.3g} mm is allowed"
                for tolerance, allowed, what in tolerances
                if not tolerance <= allowed
            ]
        return EdgeReport(
            count=len(closed.edges),
            shortest=min((edge.length for edge in closed.edges), default=0.0),
            max_gap=max((edge.gap for edge in closed.edges), default=0.0),
            max_tolerance=max((max(edge.tolerance, edge.vertex_tolerance) for edge in closed.edges), default=0.0),
        )

    def _check_whole(self, volume: Comparison, total: Comparison, centroid: tuple[Array, Array]) -> None:
        allowed = self.limits["volume"]
        for what, unit, compared in (("volume", "mm3", volume), ("area", "mm2", total)):
            if not compared.relative_error <= allowed:
                self.failures.append(
                    f"the {what} of {compared.cad:.10g} {unit} is off by {compared.relative_error:.3g}: at most "
                    f"{allowed:.3g} is allowed"
                )
        size = extent(self.built) * MM
        distance = float(np.sqrt(np.sum((centroid[0] - centroid[1]) ** 2)))
        if not distance <= allowed * size:
            self.failures.append(
                f"the centroid is {distance:.3g} mm off: at most {allowed:.3g} of the body's {size:.4g} mm is allowed"
            )


def rounded_area(net: Array) -> float:
    """How much of the area [mm2] of a face with control points (n, m, 3) [mm] a file's digits may take or add."""
    borders = (net[0], net[-1], net[:, 0], net[:, -1])
    around = sum(float(np.sum(length(np.diff(border, axis=0)))) for border in borders)
    return DIGITS * float(np.max(np.abs(net))) * around
