"""The measurement of a CAD file, from anywhere, against a built object."""

import os
from pathlib import Path
from typing import Any

import numpy as np
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps

from bladewright.cad.closure import Closure, closure
from bladewright.cad.deviation import deviation, native_face
from bladewright.cad.file_face import FileFace, file_face
from bladewright.cad.kernel import quiet
from bladewright.cad.native_body import MM, NativeBody, extent
from bladewright.cad.reading import CadFile, format_of, read_cad_file
from bladewright.cad.round_trip import Comparison, EdgeReport, FaceReport, RoundTrip
from bladewright.numerics.elementary import Array
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface

SAMPLES = 10_000
"""points on each face, each way"""
SAME_FACE = 0.01
"""Distance of control points, of the body's extent, below which a face without a name is taken for a native one."""
QUADRATURE = (1e-3, 1e-7, 1e-9, 1e-12)
"""relative errors that the kernel's quadrature of volumes aims at in turn: design/cad_quadrature.py"""
SAFE_SHARE = 0.2
"""share of a limit within which the first quadrature will do"""


def verify(path: str | os.PathLike[str], built: NativeBody, *, samples: int = SAMPLES) -> RoundTrip:
    """The round trip of a CAD file: what it holds, and how far that is from a built object.

    STEP, IGES and BREP files are measured face by face, whoever wrote them and however their surfaces are parametrised;
    STL and 3MF files triangle by triangle. Raises CadError where the file cannot be opened as what its name says.
    """
    path = Path(path)
    if format_of(path) in {"STL", "3MF"}:
        from bladewright.cad.mesh_verification import verify_mesh

        return verify_mesh(path, built, samples=samples)
    opened = read_cad_file(path)
    with quiet():
        return _Measurement(opened, built, samples).report()


def limits_of(built: NativeBody) -> dict[str, float]:
    """Limits of the figures: millimetres for distances, fractions for areas and volume."""
    chords = [_chord(face) for face in built.surfaces.values() if isinstance(face, TrimmedSurface)]
    end = max([1e-5, *(1e-7 * chord * MM for chord in chords)])
    return {"side_mm": 1e-6, "end_mm": end, "edge_mm": 1e-6, "face_area": 1e-9, "volume": 1e-6}


def _chord(face: TrimmedSurface) -> float:
    """[m] Distance of the ends of the first boundary curve."""
    ends = face.boundary[0].control_points[[0, -1]]
    start, end = face.surface(ends[:, 0], ends[:, 1])
    return float(np.sqrt(np.sum((end - start) ** 2)))


class _Measurement:
    """One file against one built object."""

    def __init__(self, opened: CadFile, built: NativeBody, samples: int) -> None:
        self.opened, self.built, self.samples = opened, built, samples
        self.limits = limits_of(built)
        self.meant = {name: native_face(face) for name, face in built.surfaces.items()}
        self.returned = [file_face(face) for face in opened.faces]
        self.named = {k: name for k, name in opened.names.items() if name in self.meant}
        self.names = self._names()
        self.failures: list[str] = []

    def report(self) -> RoundTrip:
        """The whole round trip."""
        self._check_names()
        faces = tuple(
            self._face(name, [face for k, face in enumerate(self.returned) if self.names[k] == name])
            for name in self.meant
            if name in self.names.values()
        )
        closed = closure(self.opened.shape)
        self._check_closure(closed)
        edges = self._edges(closed)
        properties = self.built.properties
        volume, centroid = self._whole()
        total = Comparison(cad=sum(face.area for face in self.returned), native=float(properties.area) * MM**2)
        self._check_whole(volume, total, centroid)
        promises: Any = getattr(self.built, "conformance", None)
        return RoundTrip(
            file=self.opened.path.name,
            format=self.opened.format,
            schema=self.opened.schema,
            unit=self.opened.unit,
            failures=tuple(self.failures),
            limits=self.limits,
            solids=closed.solids,
            shells=closed.shells,
            free_edges=closed.free,
            valid=closed.valid,
            faces=faces,
            edges=edges,
            volume=volume,
            area=total,
            centroid=centroid,
            promises=None if promises is None else promises.to_dict(),
        )

    def _whole(self) -> tuple[Comparison, tuple[Array, Array]]:
        """Volume and centroid, of the file and native; a kernel that disagrees is asked for more digits."""
        native = float(self.built.properties.volume) * MM**3, np.asarray(self.built.properties.centroid) * MM
        for bound in QUADRATURE:
            whole = GProp_GProps()
            BRepGProp.VolumeProperties_s(self.opened.shape, whole, bound)
            middle = whole.CentreOfMass()
            centroid = np.array([middle.X(), middle.Y(), middle.Z()])
            volume = Comparison(cad=whole.Mass(), native=native[0])
            off = float(np.linalg.norm(centroid - native[1])) / (extent(self.built) * MM)
            if max(volume.relative_error, off) < SAFE_SHARE * self.limits["volume"]:
                break
        return volume, (centroid, native[1])

    def _names(self) -> dict[int, str]:
        """Names of all faces of the file: those it has, else those of the native faces they lie on."""
        names = dict(self.named)
        near = SAME_FACE * extent(self.built) * MM
        for k, face in enumerate(self.returned):
            if k in names:
                continue
            nearest = near
            for name, meant in self.meant.items():
                pair = meant.pole_for_pole(face.region)
                # a pole that moved this far is not another face, but a bad one
                moved = np.inf if pair is None else np.max(np.abs(pair[1].control_points - MM * pair[0].control_points))
                if moved < nearest:
                    names[k], nearest = name, float(moved)
            if k not in names:
                # the boundary says which face it is meant to be, even where the wrong side of it was kept
                away = {name: meant.target.closest(face.outline, 0.0)[1].max() for name, meant in self.meant.items()}
                names[k] = min(away, key=lambda name: float(away[name]))
        return names

    def _check_names(self) -> None:
        missing = [name for name in self.meant if name not in self.names.values()]
        if missing:
            self.failures.append(f"no face of the file is {' or '.join(missing)}")
        if self.opened.format == "STEP" and self.opened.ours:
            unnamed = [self.names[k] for k in range(len(self.returned)) if k not in self.named]
            self.failures += [f"face {name} has no name in the file" for name in unnamed]

    def _face(self, name: str, faces: list[FileFace]) -> FaceReport:
        native = self.built.surfaces[name]
        untrimmed = isinstance(native, Surface)
        limit = self.limits["side_mm" if untrimmed else "end_mm"]
        found = deviation(self.meant[name], [face.region for face in faces], self.samples, limit)
        compared = Comparison(cad=sum(face.area for face in faces), native=self._area(name) * MM**2)
        trip = FaceReport(
            name=name,
            samples=self.samples,
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
        # the area of a trimmed face follows its boundary, which may lie as far off as the gap
        allowed = self.limits["face_area" if untrimmed else "volume"]
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
        return self.meant[name].area

    def _check_closure(self, closed: Closure) -> None:
        for count, what in ((closed.solids, "solid"), (closed.shells, "shell")):
            if count != 1:
                self.failures.append(f"the file holds {count} {what}s: one closed body is one {what}")
        if closed.free:
            self.failures.append(f"{closed.free} edges belong to one face only: the body is open")
        if closed.crowded:
            self.failures.append(f"{closed.crowded} edges do not belong to two faces that run opposite ways")
        if not closed.valid:
            self.failures.append("OpenCASCADE finds the shape invalid")

    def _edges(self, closed: Closure) -> EdgeReport:
        for joint in closed.joints:
            names = sorted({self.names[k] for k in joint.faces})
            sides = all(isinstance(self.built.surfaces[name], Surface) for name in names)
            limit = self.limits["edge_mm" if sides else "end_mm"]
            where = f"the edge of {' and '.join(names)} ({joint.length:.4g} mm long)"
            if not joint.gap <= limit:
                self.failures.append(f"{where} has a gap of {joint.gap:.3g} mm: at most {limit:.3g} mm is allowed")
            # a vertex between sides ends edges of the walls as well
            tolerances = ((joint.tolerance, limit, "a"), (joint.vertex_tolerance, self.limits["end_mm"], "a vertex of"))
            self.failures += [
                f"{where} has {what} tolerance of {tolerance:.3g} mm: at most {allowed:.3g} mm is allowed"
                for tolerance, allowed, what in tolerances
                if not tolerance <= allowed
            ]
        return EdgeReport(
            count=len(closed.joints),
            shortest=min((joint.length for joint in closed.joints), default=0.0),
            max_gap=max((joint.gap for joint in closed.joints), default=0.0),
            max_tolerance=max((max(joint.tolerance, joint.vertex_tolerance) for joint in closed.joints), default=0.0),
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
