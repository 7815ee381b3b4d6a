"""A CAD file measured against a row: its part once, like a lone blade, and where each copy of it stands."""

from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from itertools import product

import numpy as np
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps
from OCP.TopAbs import TopAbs_FACE, TopAbs_SOLID
from OCP.TopExp import TopExp, TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS, TopoDS_Solid
from OCP.TopTools import TopTools_IndexedMapOfShape

from bladewright.cad.native_body import MM, extent
from bladewright.cad.placement import matrix_of, transformation
from bladewright.cad.reading import CadFile, subshapes
from bladewright.cad.round_trip import Comparison, EdgeReport, FaceReport, PlacementReport, RoundTrip
from bladewright.domain.row import Row
from bladewright.errors import CadError
from bladewright.numerics.elementary import Array
from bladewright.nurbs.surface import Surface

PLACEMENT_LIMIT = 1e-6
"""[mm] Largest displacement of a blade of a row. OpenCASCADE writes directions with twelve digits, which displace a
blade at a radius of 300 mm by 6e-11 mm; this is no limit on precision but on errors."""
SAME_PLACE = 1e-3
"""Distance of the centroids, of the blade's extent, within which a part of a file is taken to stand where the blade
does, so that its placements count from there. A part drawn elsewhere is measured where its first placement puts it."""

Motion = tuple[Array, Array]
"""Matrix (3, 3) and shift (3,) [mm]."""


def row_trip(opened: CadFile, row: Row, measured: Callable[[CadFile], RoundTrip]) -> RoundTrip:
    """The round trip of a file against a row; `measured` gives that of a file of one blade.

    Solids that share their geometry are one part and measured once; a file of separate solids is measured solid by
    solid. Raises CadError where there is none.
    """
    solids = opened.solids
    if not solids:
        raise CadError(f"{opened.path} holds no solid: it is not the file of a row; write it again, with solids")
    standing = [(matrix, shift * MM) for matrix, shift in ((place.turn, place.shift) for place in row.placements)]
    middle = np.asarray(row.blade.properties.centroid) * MM
    wanted = np.array([_moved(motion, middle) for motion in standing])
    parts = [next(j for j, other in enumerate(solids) if other.IsPartner(solid)) for solid in solids]
    middles = {j: _centroid(solids[j].Located(TopLoc_Location())) for j in dict.fromkeys(parts)}
    located = [matrix_of(solid.Location().Transformation()) for solid in solids]
    found = [_moved(motion, middles[j]) for motion, j in zip(located, parts, strict=True)]
    nearest = [int(np.argmin(np.sum((wanted - place) ** 2, axis=1))) for place in found]
    trips: dict[int, RoundTrip] = {}
    own: dict[int, Motion] = {}
    for j, place in middles.items():
        away = float(np.sqrt(np.sum((place - middle) ** 2)))
        stays = away <= SAME_PLACE * extent(row.blade) * MM
        own[j] = (np.eye(3), np.zeros(3)) if stays else _after(_inverse(standing[nearest[j]]), located[j])
        trips[j] = measured(_part_file(opened, solids[j], own[j]))
    failures = [
        f"{row.placements[nearest[j]].name}: {failure}" if len(trips) > 1 else failure
        for j, trip in trips.items()
        for failure in trip.failures
    ]
    failures += _count_failures(opened, row, nearest)
    # points of the native blade, in the file at its place: back to the part's own coordinates, and placed
    motions = [_after(motion, _inverse(own[j])) for motion, j in zip(located, parts, strict=True)]
    box = _box(row)
    placements = []
    for motion, k in zip(motions, nearest, strict=True):
        away = float(np.sqrt(np.max(np.sum((_moved(motion, box) - _moved(standing[k], box)) ** 2, axis=-1))))
        placements.append(PlacementReport(name=row.placements[k].name, displacement=away))
        if not away <= PLACEMENT_LIMIT:
            name = row.placements[k].name
            failures.append(f"{name} is {away:.3g} mm away from its place: at most {PLACEMENT_LIMIT:g} mm is allowed")
    first = next(iter(trips.values()))
    of_solid = [trips[j] for j in parts]
    volume, area, centroid = _whole(row, of_solid, motions, first.limits["volume"], failures)
    return replace(
        first,
        failures=tuple(failures),
        limits={**first.limits, "placement_mm": PLACEMENT_LIMIT},
        solids=sum(trip.solids for trip in of_solid),
        shells=sum(trip.shells for trip in of_solid),
        free_edges=sum(trip.free_edges for trip in of_solid),
        valid=all(trip.valid for trip in trips.values()),
        faces=_worst_faces(list(trips.values())),
        edges=_worst_edges([trip.edges for trip in trips.values()]),
        volume=volume,
        default_volume=Comparison(cad=sum(_shown(trip) for trip in of_solid), native=volume.native),
        area=area,
        centroid=centroid,
        placements=tuple(placements),
    )


def _part_file(opened: CadFile, solid: TopoDS_Solid, motion: Motion) -> CadFile:
    """The file of one solid, moved to where the native blade stands, with the names of its faces."""
    every = TopTools_IndexedMapOfShape()
    TopExp.MapShapes_s(opened.shape, TopAbs_FACE, every)
    numbers = [every.FindIndex(face) - 1 for face in subshapes(solid, TopAbs_FACE)]
    still = np.array_equal(motion[0], np.eye(3)) and not motion[1].any()
    place = TopLoc_Location() if still else TopLoc_Location(transformation(*motion))
    names = {k: opened.names[number] for k, number in enumerate(numbers) if number in opened.names}
    return replace(opened, shape=TopoDS.Solid_s(solid.Located(place)), names=names, solid_names=())


def _count_failures(opened: CadFile, row: Row, nearest: list[int]) -> list[str]:
    """What is lost, doubled, misnamed or loose."""
    names = [each.name for each in row.placements]
    counts = Counter(nearest)
    failures = []
    if len(nearest) != len(names):
        failures.append(f"the file holds {len(nearest)} solids: the row has {len(names)} blades")
    failures += [f"{name} is missing" for k, name in enumerate(names) if k not in counts]
    failures += [f"{counts[k]} blades stand where {names[k]} does" for k in sorted(counts) if counts[k] > 1]
    if TopExp_Explorer(opened.shape, TopAbs_FACE, TopAbs_SOLID).More():
        failures.append("the file holds faces outside its solids: one closed body is one solid")
    if opened.format == "STEP" and opened.written_by_bladewright:
        failures += [
            f"{names[k]} is called {given!r} in the file"
            for k, given in zip(nearest, opened.solid_names, strict=True)
            if given != names[k]
        ]
    return failures


def _whole(
    row: Row, trips: list[RoundTrip], motions: list[Motion], allowed: float, failures: list[str]
) -> tuple[Comparison, Comparison, tuple[Array, Array]]:
    """Volume, area and centroid of all blades of the file together beside the native ones."""
    native, volumes = row.properties, np.array([trip.volume.cad for trip in trips])
    volume = Comparison(cad=float(volumes.sum()), native=float(native.volume) * MM**3)
    area = Comparison(cad=sum(trip.area.cad for trip in trips), native=float(native.area) * MM**2)
    middles = np.array([_moved(motion, trip.centroid[0]) for trip, motion in zip(trips, motions, strict=True)])
    centroid = volumes @ middles / volumes.sum(), np.asarray(native.centroid) * MM
    for what, unit, compared in (("volume", "mm3", volume), ("area", "mm2", area)):
        if not compared.relative_error <= allowed:
            failures.append(
                f"the {what} of all blades of {compared.cad:.10g} {unit} is off by {compared.relative_error:.3g}: at "
                f"most {allowed:.3g} is allowed"
            )
    return volume, area, centroid


def _shown(trip: RoundTrip) -> float:
    return trip.volume.cad if trip.default_volume is None else trip.default_volume.cad


def _worst_faces(trips: list[RoundTrip]) -> tuple[FaceReport, ...]:
    """Of each face, the report with the largest deviation."""
    worst: dict[str, FaceReport] = {}
    for face in (each for trip in trips for each in trip.faces):
        if face.name not in worst or face.max_deviation > worst[face.name].max_deviation:
            worst[face.name] = face
    return tuple(worst.values())


def _worst_edges(edges: list[EdgeReport]) -> EdgeReport:
    return EdgeReport(
        count=max(each.count for each in edges),
        shortest=min(each.shortest for each in edges),
        max_gap=max(each.max_gap for each in edges),
        max_tolerance=max(each.max_tolerance for each in edges),
    )


def _box(row: Row) -> Array:
    """Corners (8, 3) [mm] of the box around the blade's control points."""
    nets = [face.control_points for face in row.blade.surfaces.values() if isinstance(face, Surface)]
    points = np.concatenate([np.real(net).reshape(-1, 3) for net in nets]) * MM
    return np.array(list(product(*zip(points.min(axis=0), points.max(axis=0), strict=True))))


def _centroid(solid: TopoDS_Solid) -> Array:
    """Centroid (3,) [mm], close enough to tell blades apart."""
    whole = GProp_GProps()
    BRepGProp.VolumeProperties_s(solid, whole)
    middle = whole.CentreOfMass()
    return np.array([middle.X(), middle.Y(), middle.Z()])


def _moved(motion: Motion, points: Array) -> Array:
    return np.asarray(points @ motion[0].T + motion[1])


def _after(second: Motion, first: Motion) -> Motion:
    return second[0] @ first[0], second[0] @ first[1] + second[1]


def _inverse(motion: Motion) -> Motion:
    return motion[0].T, -motion[0].T @ motion[1]
