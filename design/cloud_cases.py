"""Fits the four examples whose real shapes are known as clouds of points, and prints what they reach.

python design/cloud_cases.py [--measure] [ls89 aachen rotor radial]

Needs ../shared/data/clouds. Writes the built-in examples, whose comments stay; with --measure it reads them instead.
"""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from cloud_fit import Fitting
from cloud_laws import Free, Weights, free_parameters
from cloud_start import Camber, Outline, first_camber, outline, wall_places

from bladewright.blade.channel import Channel
from bladewright.blade.unified import UnifiedBlade
from bladewright.designs import Point
from bladewright.files.reading import read_design
from bladewright.files.writing import write_design
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.closest import closest_on_surface

ROOT = Path(__file__).resolve().parents[1]
CLOUDS = ROOT.parent / "shared" / "data" / "clouds"


@dataclass(frozen=True, kw_only=True)
class Case:
    """How one cloud is read and what structure its design is given."""

    cloud: str
    design: dict[str, object]
    """fields that are not fitted"""
    counts: dict[str, int] = field(default_factory=dict)
    """control points of the channel's curves"""
    hub: list[tuple[float, float]] = field(default_factory=list)
    """rough polyline (x, r) [m]"""
    shroud: list[tuple[float, float]] = field(default_factory=list)
    span: int = 1
    """control points of a law"""
    chord: int = 6
    """control points of a thickness law along the chord"""
    given: dict[str, float] = field(default_factory=dict)
    """parameters that are given, not fitted"""
    held: tuple[str, ...] = ()
    """beginnings of paths that stay at their start: they would only slide points along a curve"""
    spans: dict[str, int] = field(default_factory=dict)
    """control points of single laws; `thickness_edges` of the first and last control points along the chord"""
    high: dict[str, float] = field(default_factory=dict)
    """upper bounds by the beginnings of paths"""
    weights: Weights = field(default_factory=Weights)
    rounds: int = 60


CASES = {
    "vki-ls89": Case(
        cloud="LS89_2D",
        design={"arrangement": "linear", "pitch": 57.5},
        chord=7,
        given={
            "metal_angle_in": 0.0,
            "metal_angle_out": -73.0,
            "leading_edge_radius": 0.1116,
            "trailing_edge_radius": 0.01919,
        },
    ),
    "aachen-stator": Case(
        cloud="Aachen_3D",
        design={"blade_count": 36},
        counts={"hub": 2, "shroud": 2, "leading_edge": 2, "trailing_edge": 2},
        hub=[(0.0, 0.49), (0.044, 0.49)],
        shroud=[(0.0, 0.6), (0.044, 0.6)],
        span=2,
        chord=7,
        high={"trailing_edge_radius": 0.02},
    ),
    "nasa-rotor-67": Case(
        cloud="NASA_R67",
        design={"blade_count": 22},
        counts={"hub": 4, "shroud": 4, "leading_edge": 4, "trailing_edge": 6},
        hub=[(-0.0007, 0.0959), (0.0896, 0.118)],
        shroud=[(0.0241, 0.2552), (0.065, 0.2479)],
        span=5,
        chord=6,
        spans={
            "leading_edge_radius": 2,
            "trailing_edge_radius": 2,
            "thickness_edges": 2,
            "tangent_in": 4,
            "tangent_out": 4,
        },
        weights=Weights(smooth=1e-3, centred=3e-3, near=3e-4, edges=0.01),
        high={"tangent": 0.6},
        held=(
            *(f"channel.leading_edge[{i}].r" for i in (1, 2)),
            *(f"channel.trailing_edge[{i}].r" for i in (1, 2, 3, 4)),
            *(f"channel.{wall}[{i}].x" for wall in ("hub", "shroud") for i in (0, 1)),
        ),
    ),
    "radial-turbine": Case(
        cloud="APU_rotor",
        design={"blade_count": 12},
        counts={"hub": 6, "shroud": 6, "leading_edge": 2, "trailing_edge": 2},
        hub=[(0.0, 0.0582), (0.001, 0.037), (0.01, 0.023), (0.026, 0.016), (0.039, 0.015)],
        shroud=[(0.00635, 0.0582), (0.009, 0.047), (0.015, 0.04), (0.035, 0.037)],
        span=4,
        chord=7,
        weights=Weights(centred=3e-3),
    ),
}


def read_cloud(name: str) -> Reals:
    """Points (n, 3) in the product's axes [m]; a 2D cloud lies at z = 0."""
    rows = np.loadtxt(CLOUDS / f"{name}.txt")
    if rows.shape[1] == 3:
        rows = np.unique(rows[:, 1:], axis=0)
        return np.column_stack([rows, np.zeros(len(rows))])
    return rows[:, [3, 2, 1]]


def cascade_start(case: Case, name: str, points: Reals, height: float = 0.1) -> tuple[UnifiedBlade, dict[str, Reals]]:
    """A first prismatic design between z = 0 and `height` [m]."""
    low, high = np.min(points[:, 0]), np.max(points[:, 0])
    curves = {
        "hub": np.array([[low, 0.0], [high, 0.0]]), "shroud": np.array([[low, height], [high, height]]),
        "leading_edge": np.array([[low, 0.0], [low, height]]), "trailing_edge": np.array([[high, 0.0], [high, height]]),
    }  # fmt: skip
    found = Outline(curves=curves, u=(points[:, 0] - low) / (high - low), v=np.full(len(points), 0.5))
    camber = first_camber(found, points[:, 1], annular=False, count=1, along_v=0)
    return _started(case, name, found, camber), {}


def annular_start(case: Case, name: str, points: Reals) -> tuple[UnifiedBlade, dict[str, Reals]]:
    """A first annular design, and the cloud's places on hub and shroud."""
    places = np.stack([points[:, 0], np.hypot(points[:, 1], points[:, 2])], axis=-1)
    found = outline(places, np.array(case.hub), np.array(case.shroud), case.counts)
    theta = np.arctan2(points[:, 1], points[:, 2])
    camber = first_camber(found, theta, annular=True, count=case.span)
    return _started(case, name, found, camber), wall_places(found, places)


def _started(case: Case, name: str, found: Outline, camber: Camber) -> UnifiedBlade:
    def points(name: str, inner: bool) -> tuple[Point, ...]:
        rows = found.curves[name] * 1e3
        return tuple(Point(float(x), float(r)) for x, r in (rows[1:-1] if inner else rows))

    def law(values: tuple[float, ...], low: float = -75.0, high: float = 75.0) -> object:
        values = tuple(float(np.clip(x, low, high)) for x in values)
        return values if len(values) > 1 else values[0]

    linear = case.design.get("arrangement") == "linear"
    t = camber.thickness
    shape = (0.6, *(1.0,) * (case.chord - 2), 0.5)
    place = law(tuple(x * 1e3 if linear else x for x in camber.theta), -1e3, 1e3)
    ends = case.spans.get("thickness_edges", case.span)
    spans = (ends, *(case.span,) * (case.chord - 2), ends)
    thickness = tuple(law((t * f,) * n) for f, n in zip(shape, spans, strict=True))
    even = {"tangent_in": 0.35, "tangent_out": 0.35, "leading_edge_radius": 0.3 * t, "trailing_edge_radius": 0.2 * t}
    return UnifiedBlade(
        name=name,
        length_unit="mm",
        **{"leading_edge_y" if linear else "leading_edge_theta": place},
        stagger=law(camber.stagger),
        metal_angle_in=law(camber.angle_in),
        metal_angle_out=law(camber.angle_out),
        **{k: law((x,) * case.spans.get(k, case.span)) for k, x in even.items()},
        thickness_upper=thickness,
        thickness_lower=thickness,
        channel=Channel(**{k: points(k, k in ("hub", "shroud")) for k in found.curves}),
        **case.design,
    )


def fitted(name: str, case: Case, report: Callable[[str], None] = print) -> UnifiedBlade:
    """The design of a case, from its cloud alone."""
    points = read_cloud(case.cloud)
    linear = case.design.get("arrangement") == "linear"
    design, walls = (cascade_start if linear else annular_start)(case, name, points)
    design = design.changed(case.given)
    chord = float(np.max(np.linalg.norm(points - points[0], axis=-1))) if linear else 0.06
    if linear:
        points = points + np.array([0.0, 0.0, 0.05])
        free = free_parameters(design, chord, ("channel", *case.given))
        free += [
            Free(paths=tuple(f"channel.{edge}[{i}].x" for i in (0, 1)), size=1.0)
            for edge in ("leading_edge", "trailing_edge")
        ]
    else:
        free = free_parameters(design, chord, (*case.given, *case.held))
    free = [replace(f, high=next((b for k, b in case.high.items() if f.paths[0].startswith(k)), f.high)) for f in free]
    start = time.perf_counter()
    for stage, each in enumerate((Weights(smooth=1e-2, centred=1e-2, near=1e-3, edges=0.05), case.weights)):
        fitting = Fitting(
            points=points, walls=walls, start=design, free=free, weights=each, tolerance=(1e-4, 1e-5)[stage]
        )
        design, result = fitting.solve(case.rounds // (2 - stage))
        on = fitting.feet(design)
        mean, worst = (value(on.distances) for value in (np.mean, np.max))
        percent = 100.0 / fitting.chord
        report(
            f"{name} stage {stage}: {len(free)} parameters, {result.nfev} evaluations, "
            f"{time.perf_counter() - start:.0f} s, mean {mean * 1e3:.4f} mm = {mean * percent:.4f} %, "
            f"max {worst * 1e3:.4f} mm = {worst * percent:.3f} % of {fitting.chord * 1e3:.2f} mm; {result.message}"
        )
    return design


def rounded(design: UnifiedBlade) -> UnifiedBlade:
    """The design with numbers as long as their effect on the shape deserves: a few micrometres."""

    def digits(path: str) -> int:
        if "radius" in path or "thickness" in path:
            return 5
        return 4 if "tangent" in path else 2 if "stagger" in path or "angle" in path else 3

    return design.changed({path: round(value, digits(path)) for path, value in design.parameters().items()})


def measured(name: str, case: Case, design: UnifiedBlade) -> str:
    """What a design reaches: true distances of the cloud from the built surfaces."""
    start = time.perf_counter()
    blade = design.build()
    spent = time.perf_counter() - start
    points = read_cloud(case.cloud)
    if blade.design.arrangement == "linear":
        points = points + np.array([0.0, 0.0, 0.05])
    sides = (blade.surfaces["upper"], blade.surfaces["lower"])
    distances = np.min([closest_on_surface(side, points, tolerance=1e-7).distances for side in sides], axis=0)
    mean, worst = np.mean(distances), np.max(distances)
    return (
        f"{name}: {len(design.parameters())} parameters, {blade.knots.poles[0]} x {blade.knots.poles[1]} poles a side, "
        f"built in {spent:.2f} s, promises {'kept' if blade.promises.kept else 'BROKEN'}, mean {mean * 1e3:.4f} mm = "
        f"{mean / blade.chord:.4%}, max {worst * 1e3:.4f} mm = {worst / blade.chord:.3%} of {blade.chord * 1e3:.2f} mm"
    )


if __name__ == "__main__":
    only_measure = "--measure" in sys.argv
    words = [word for word in sys.argv[1:] if not word.startswith("--")]
    for name, case in CASES.items():
        if not words or any(word in name for word in words):
            path = ROOT / "src" / "bladewright" / "examples" / f"{name}.toml"
            if not only_measure:
                design = rounded(fitted(name, case))
                kept = read_design(path).description if path.is_file() else ""
                write_design(design.changed("description", kept), path)
            print(measured(name, case, read_design(path)))
