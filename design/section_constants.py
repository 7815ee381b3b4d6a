"""What the numerical constants of `bladewright.section` buy: results with other values of each, against the finest.

    python design/section_constants.py

Shapes: the sections of all built-in examples, and one section of each family made here. What was recorded stands in
README.md.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from importlib import resources
from types import ModuleType
from typing import Any
from unittest.mock import patch

import numpy as np

import bladewright as bw
from bladewright.section import (
    arc_length,
    camber_by_angle,
    chebyshev_pieces,
    chord_spline,
    native,
    smooth_camber,
    smoothness,
)
from bladewright.section import section as section_module
from bladewright.section.laws import Span
from bladewright.section.outline import Outline
from bladewright.section.profiles import naca5, points_outline

ONE = Span(np.zeros(1))
U = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 401))) / 2.0


def outlines() -> dict[str, Outline]:
    """One section of each family."""
    thickness = bw.Wennerstrom(
        maximum_thickness=0.08,
        maximum_thickness_at=0.45,
        leading_edge_thickness=0.012,
        trailing_edge_thickness=0.012,
    )
    around = 2.0 * np.pi * np.arange(40) / 40.0
    oval = (0.5 * np.cos(around), 0.06 * np.sin(around) + 0.05 * np.cos(2.0 * around))
    parts = {
        "naca-2412": bw.Naca4(camber=0.02, camber_position=0.4, thickness=0.12),
        "naca-23112": bw.Naca5(thickness=0.12, reflexed=True),
        "64-212": bw.Naca6(series="64", design_lift=0.2, thickness=0.12, trailing_edge="round"),
        "c4": bw.C4(thickness=0.1, camber_angle=30.0, trailing_edge="round"),
        "arcs": bw.DoubleCircularArc(thickness=0.06, camber_angle=30.0, leading_edge_radius=0.004),
        "points": bw.PointsProfile(abscissas=tuple(oval[0]), ordinates=tuple(oval[1])),
        "meanline": bw.CurvatureMeanline(
            metal_angle_in=55.0,
            metal_angle_out=10.0,
            curvature=(1.0, 2.0, 0.5, 0.3),
            curvature_places=(0.1, 0.6),
            thickness=thickness,
        ),
        "camber angle": bw.CamberAngle(
            camber_angle=(-60.0, -30.0, 20.0, 50.0), half_thickness=(0.02, 0.06, 0.05, 0.02, 0.01)
        ),
    }
    return {name: part.outline(ONE) for name, part in parts.items()}


@contextmanager
def having(module: ModuleType, **values: Any) -> Iterator[None]:
    """The module with other values of its constants."""
    with patch.multiple(module, **values):
        yield


def differences(title: str, module: ModuleType, values: list[dict[str, Any]], figure: Callable[[], Any]) -> None:
    """Largest difference of a figure from that with the last values, for each of the others."""
    found = []
    for each in values:
        with having(module, **each):
            found.append(np.concatenate([np.ravel(np.real(part)) for part in figure()]))
    for each, own in zip(values[:-1], found[:-1], strict=True):
        print(f"{title}  {each}: {np.max(np.abs(own - found[-1])):.1e}")


def arc_figures() -> list[Any]:
    """Arc lengths of all camber lines, and parameters at arc lengths."""
    figures = []
    for outline in outlines().values():
        arc = arc_length.ArcLength(lambda s, line=outline: line.camber(s).reshape(-1, 2), [0.0, *outline.breaks, 1.0])
        figures += [arc.lengths(U), arc.places(U)]
    return figures


def turning_figures() -> list[Any]:
    """theta of a camber line whose angle sweeps from -80 to 80 deg, where m' and the length differ."""
    part = bw.CamberAngle(camber_angle=(-80.0, -30.0, 20.0, 80.0), half_thickness=(0.02, 0.06, 0.05, 0.02, 0.01))

    def meridional(fractions: Any) -> Any:
        return ((np.exp(1.5 * fractions) - 1.0) / (np.exp(1.5) - 1.0))[None]

    return [outline.line.total for outline in (part.outline(ONE), part.outline(ONE, meridional))]


def factors() -> list[Any]:
    """k1 of mean lines, plain and reflexed."""
    parts = [bw.Naca5(thickness=0.12, camber_position=p, reflexed=r) for p in (0.05, 0.25) for r in (False, True)]
    return [part.outline(ONE).mean_line.factor for part in parts]


def series_error(outline: Outline) -> list[float]:
    """Error of the first three derivatives by Chebyshev series, of the largest, where they are known exactly."""
    s = U[1:-1]
    exact = outline.derivatives(s, 3)[0].reshape(len(s), 2, 4)
    pieces = chebyshev_pieces.ChebyshevPieces(
        lambda at: outline.points(at)[0].reshape(-1, 2), np.array([0.0, *outline.breaks, 1.0])
    )
    found = pieces.derivatives(s, 3)
    return [float(np.max(np.abs(found - exact)[..., k]) / np.max(np.abs(exact[..., k]))) for k in (1, 2, 3)]


def examples() -> Iterator[tuple[str, Any]]:
    """Sections at mid-span of the built-in examples."""
    for file in sorted((resources.files("bladewright") / "examples").iterdir(), key=lambda each: each.name):
        if file.name.endswith(".toml"):
            design = bw.read_design(file)
            built = design.build()
            yield file.name[:-5], built if not hasattr(built, "section") else built.section(0.5)


def sides_with(outline: Outline, sides: Any) -> native.SectionKnots:
    """The knots of a section with others of the sides."""
    return replace(native.knots_for(outline, 1e-8), sides=sides)


def properties(section: Any) -> list[float]:
    """Chord, area and perimeter relative to what the section has with its own constants."""
    fresh = replace(section)
    own = section.chord, section.area, section.perimeter
    return [float(np.real(new / old)) for new, old in zip((fresh.chord, fresh.area, fresh.perimeter), own, strict=True)]


def unsolved(*_: Any) -> Any:
    """In the place of the bracketed search: says that it was needed."""
    raise ArithmeticError


def main() -> None:
    """All figures."""
    shapes, sections = outlines(), dict(examples())
    counts = [{"NODES": n, "MAX_NODES": n} for n in (20, 40, 80, 160, 320, 640)]
    differences("arc length", arc_length, counts, arc_figures)
    differences("arc length", arc_length, [{"STEPS": n} for n in (2, 4, 6, 12)], arc_figures)
    differences("camber angle", camber_by_angle, [{"ORDER": n} for n in (8, 12, 16, 48)], turning_figures)
    differences("camber angle", camber_by_angle, [{"CUTS": n} for n in (2, 4, 6, 18)], turning_figures)
    differences("camber angle", camber_by_angle, [{"NODES": n} for n in (6, 8, 12, 20)], turning_figures)
    for values in (
        {"NODES": 15},
        {"NODES": 25},
        {"NODES": 40},
        {"ROUNDING": 0.0},
        {"RESOLVED": 1e-10},
        {"HALVINGS": 3},
    ):
        with having(chebyshev_pieces, **values):
            for name in ("meanline", "points", "camber angle"):
                print("chebyshev pieces", name, values, ", ".join(f"{each:.0e}" for each in series_error(shapes[name])))
    lift = [{"ORDER": n} for n in (8, 16, 24, 48)]
    differences("naca5 k1", naca5, lift, factors)
    for steps in (1, 2, 3, 4, 6, 12):
        with having(chord_spline, NEWTON=steps, bracketed_root=unsolved):
            try:
                shapes["meanline"].points(U), outlines()["meanline"].points(U)
                print("chord spline: Newton steps enough", steps)
                break
            except ArithmeticError:
                continue
    totals = [{"PER_SPAN": n} for n in (4, 8, 12, 24)]
    differences("section properties", section_module, totals, lambda: [properties(each) for each in sections.values()])
    poles = {name: len(each.curves["upper"].control_points) for name, each in sections.items()}
    poles |= {name: len(native.native_curves(each, 1e-10)[0].control_points) for name, each in shapes.items()}
    print("poles at 1e-10:", poles)
    for shares in ((0.5,), (0.25, 0.75), native.SHARES):
        missed = []
        for outline in shapes.values():
            with having(native, SHARES=shares):
                knots = native.side_knots_for(outline, 1e-8)
            s = (knots[5:-6, None] + np.diff(knots[5:-5])[:, None] * np.linspace(0.0, 1.0, 41)).ravel()
            curve = native.native_curves(outline, 1e-8, sides_with(outline, knots))[0]
            missed.append(np.max(np.hypot(*(np.real(curve(s)) - outline.points(s)[0].reshape(-1, 2)).T)) / 1e-8)
        print("native: checked at", shares, f"misses the tolerance by a factor of {max(missed):.2f} at most")
    for terms in (2, 3, 4, 6):
        with having(smooth_camber, TERMS=terms):
            off = {}
            for name, outline in shapes.items():
                own, at = outline.camber(U).reshape(-1, 2), smooth_camber.smooth_camber(outline)
                off[name] = float(np.max(np.abs(at.points(own[:, 0]).reshape(-1, 2) - own)[40:-40]))
        print("smooth camber", terms, {name: f"{value:.0e}" for name, value in off.items()})
    for camber in (4, 6, 8, 12):
        with having(points_outline, CAMBER=camber):
            outline = outlines()["points"]
            middle, line = (0.5 * sum(outline.points(U))).reshape(-1, 2), outline.camber(U).reshape(-1, 2)
            off = np.abs(np.interp(middle[:, 0], line[:, 0], line[:, 1]) - middle[:, 1])
            print("camber of points", camber, f"{np.max(off[60:-60]):.1e}")
    lines = [line for outline in shapes.values() for line in smoothness.outline_smoothness(outline).lines]
    jumps = [jump for line in lines for jump in line.jumps if jump.continuous[0]]
    worst = max(jump.of_curvature / max(1.0, *np.abs(jump.curvature)) for jump in jumps)
    print(f"largest jump of a continuous curvature: {worst:.1e}")


if __name__ == "__main__":
    main()
