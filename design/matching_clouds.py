"""Clouds for design/matching.py: measured, of the examples, of designs drawn at random, and as users bring them."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from bladewright.blade.design.unified import UnifiedBlade
from bladewright.errors import DesignError
from bladewright.files.clouds import read_cloud
from bladewright.files.examples import example_text, examples
from bladewright.files.reading import design_from, parsed
from bladewright.section.unified import UnifiedSection

SHARED = Path(__file__).resolve().parents[2] / "shared" / "data" / "clouds"
"""measured clouds, beside the repository"""
MEASURED = {
    "LS89": "LS89_2D",
    "T106": "t106eiz_2D",
    "Impulse": "Impulse_2D",
    "Aachen": "Aachen_3D",
    "Rotor67": "NASA_R67",
    "APU": "APU_rotor",
    "Aachen2D": "Aachen_2D",
}
"""the measured clouds by their names here"""
ROW = 100
"""points of a row at each end of a side"""
SHAKEN = 0.04
"""relative change of the parameters of a blade drawn at random"""
WHOLE = (0.0, 1.0, 0.0, 1.0)
PLACED = Rotation.from_rotvec([0.7, -1.1, 0.4]), np.array([0.3, -0.2, 0.5])
"""where clouds lie that have been moved [m]"""


@dataclass(frozen=True, kw_only=True)
class Cloud:
    """Points to be matched, and what is known of the truth."""

    points: np.ndarray
    """[m]"""
    others: np.ndarray | None = None
    """other points of the true shape, without noise [m]; none: the points themselves measure a match"""
    outlier: np.ndarray | None = None
    """which points were moved off"""
    design: object = None
    """the true design, where there is one"""
    options: tuple[str, ...] = ()
    """of the command line"""
    unit: float = 1e-3
    """length in which the points are written to files [m]"""


def measured(name):
    """A measured cloud."""
    flat = MEASURED[name].endswith("_2D")
    read = read_cloud(SHARED / f"{MEASURED[name]}.txt", columns=None if flat else ("skip", "z", "y", "x"))
    return Cloud(points=read.points * (100.0 if name == "T106" else 1.0))


def measured_third(name):
    """A third of a measured cloud with noise of 0.01 mm, measured by all of its points."""
    points, draw = measured(name).points, np.random.default_rng(5)
    some = draw.permutation(len(points))[: max(len(points) // 3, 100)]
    return Cloud(points=noisy(points[some], draw, 1e-5), others=points)


def example(name):
    """An example without clearance."""
    design = design_from(parsed(example_text(name), name), name)
    ends = [each for each in ("tip_clearance", "hub_clearance") if getattr(design, each, None)]
    return replace(design, **dict.fromkeys(ends))


def sides_of(built):
    """The faces of a blade or section but for its ends: sides, and faces of blunt edges."""
    if hasattr(built, "surfaces"):
        # one that a clearance trims has no knots of its own
        faces = [e for name, e in built.surfaces.items() if name.endswith("_edge") and hasattr(e, "knots_u")]
        return [*built.sides, *faces]
    faces = [each for name, each in built.curves.items() if name.endswith("_edge")]
    return [built.curves["upper"], built.curves["lower"], *faces]


def points_of(built, count, draw):
    """Points at random, as many on each side, even by area or length, and on faces of blunt edges as close or 20."""
    parts, share = [], 0.0
    for side in sides_of(built):
        if hasattr(side, "knots_u"):
            u, v = draw.random((2, 8 * count))
            places = np.stack([(1.0 - np.cos(np.pi * u)) / 2.0, v])
            across = np.cross(side.derivative(*places, 1, 0), side.derivative(*places, 0, 1))
            weight = np.sqrt(np.sum(across**2, axis=-1)) * np.sqrt(places[0] * (1.0 - places[0]))
        else:
            places = draw.random(8 * count)[None]
            weight = np.sqrt(np.sum(np.asarray(side.derivative(*places)) ** 2, axis=-1))
        # the two sides come first
        number = count // 2 if len(parts) < 2 else max(20, round(count * weight.sum() / share))
        share += weight.sum()
        parts.append(side(*places[:, draw.choice(8 * count, number, p=weight / weight.sum())]))
    return np.concatenate(parts)


def rows_of(built, draw):
    """A row of points at each end of each side of a blade, as meshes and measurements of sections have them."""
    u = (1.0 - np.cos(np.pi * draw.random((2, 2, ROW)))) / 2.0
    return np.concatenate(
        [s(u[i, j], np.full(ROW, v)) for i, s in enumerate(built.sides) for j, v in enumerate((0.0, 1.0))]
    )


def cloud_of(design, seed=4, *, count=5_000, noise=0.0, outliers=0.0, ends=True):
    """Points of a design, in rows at the ends of a blade if wanted; noise is a share of the chord."""
    draw, built = np.random.default_rng(1000 + seed), design.build()
    chord = float(np.real(built.chord))
    points, others = points_of(built, count, draw), points_of(built, 20_000, draw)
    if hasattr(built, "surfaces") and ends:
        points = np.concatenate([draw.permutation(points)[: count - 4 * ROW], rows_of(built, draw)])
    points = draw.permutation(points)
    points, outlier = with_outliers(noisy(points, draw, noise * chord), draw, outliers, 0.01 * chord, 0.05 * chord)
    return Cloud(points=points, others=others, outlier=outlier, design=design)


def with_outliers(points, draw, share, least, most):
    """Points of which a share is moved off by a length between two, in any direction, and which these are."""
    off = np.zeros(len(points), dtype=bool)
    off[draw.choice(len(points), round(share * len(points)), replace=False)] = True
    direction = draw.normal(size=points.shape)
    direction /= np.sqrt(np.sum(direction**2, axis=-1, keepdims=True))
    return points + direction * (off * draw.uniform(least, most, len(points)))[:, None], off


def section(seed):
    """A section drawn at random: a vane, a compressor's or a turbine's."""
    draw = np.random.default_rng(seed)
    while True:
        stagger = draw.uniform(-60.0, 60.0)
        turn = draw.uniform(0.0, 55.0) * draw.choice([-1.0, 1.0])
        thickness = np.exp(draw.uniform(np.log(0.04), np.log(0.2)))
        bulge = [np.sin(np.pi * np.linspace(0.12, 0.95, draw.integers(4, 8))) ** 0.7 for _ in range(2)]
        share = draw.uniform(0.3, 1.0, 2)
        try:
            design = UnifiedSection(
                name=f"section-{seed}",
                length_unit="mm",
                axial_chord=draw.uniform(30.0, 90.0),
                stagger=stagger,
                metal_angle_in=np.clip(stagger + turn + draw.uniform(-8.0, 8.0), -75.0, 75.0),
                metal_angle_out=np.clip(stagger - 0.6 * turn + draw.uniform(-8.0, 8.0), -78.0, 78.0),
                tangent_in=draw.uniform(0.2, 0.6),
                tangent_out=draw.uniform(0.2, 0.6),
                leading_edge_radius=0.5 * thickness * draw.uniform(0.15, 0.6),
                trailing_edge_radius=0.5 * thickness * draw.uniform(0.05, 0.25),
                thickness_upper=tuple(thickness * share[0] * bulge[0] * draw.uniform(0.85, 1.15, len(bulge[0]))),
                thickness_lower=tuple(thickness * share[1] * bulge[1] * draw.uniform(0.85, 1.15, len(bulge[1]))),
            )
            design.build()
        except DesignError:
            continue
        return design


def blade(seed):
    """One of the examples of the unified family with every parameter shaken, but for the channel, without clearance."""
    draw = np.random.default_rng(seed)
    bases = [design_from(parsed(example_text(name), name), name) for name in examples()]
    # those that a seed has always meant: the ones that leave as wheels came later
    bases = [base for base in bases if isinstance(base, UnifiedBlade) and base.disc is None]
    base = replace(bases[seed % len(bases)], tip_clearance=None, hub_clearance=None)
    values = base.parameters()
    while True:
        changes = {
            path: value * (1.0 + SHAKEN * draw.normal())
            for path, value in values.items()
            if not path.startswith(("channel.", "pitch", "tip_", "hub_"))
        }
        try:
            design = base.changed(changes)
            design.build()
        except DesignError:
            continue
        return design


BROUGHT = {
    "aachen": "aachen-stator",
    "compressor": "compressor-stator",
    "turbine": "radial-turbine",
    "impeller": "centrifugal-impeller",
    "fan": "fan-rotor",
    "propeller": "propeller",
    "ls89": "vki-ls89",
}
"""examples of which users bring clouds; of the last its section"""
SPACE = tuple(BROUGHT)[:-1]


@dataclass(frozen=True, kw_only=True)
class Truth:
    """What a cloud as users bring it is made of."""

    machine: str
    sides: tuple
    draw: np.random.Generator
    directory: Path


@dataclass(frozen=True, kw_only=True)
class Case:
    """Points of a machine, and what the command is given beside them."""

    points: np.ndarray
    options: tuple[str, ...] = ()
    shown: tuple[float, float, float, float] = WHOLE
    """u and v between which the cloud shows the blade"""
    unit: float = 1e-3
    """length in which the points are written [m]"""


def on(sides, u, v):
    """Points of both sides at places (2, n)."""
    flat = not hasattr(sides[0], "knots_u")
    return np.concatenate(
        [side(*((each,) if flat else (each, at))) for side, each, at in zip(sides, u, v, strict=True)]
    )


def scattered(sides, count, draw, shown=WHOLE):
    """Points at random on both sides, denser at the edges."""
    u = (1.0 - np.cos(np.pi * draw.random((2, count // 2)))) / 2.0
    v = draw.random((2, count // 2))
    return on(sides, shown[0] + u * (shown[1] - shown[0]), shown[2] + v * (shown[3] - shown[2]))


def rows(sides, across=21, along=80, shown=WHOLE):
    """Points in rows along the chord, as meshes and measurements have them."""
    if not hasattr(sides[0], "knots_u"):
        across, along = 1, 300
    u = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, along))) / 2.0
    u, v = np.meshgrid(shown[0] + u * (shown[1] - shown[0]), np.linspace(*shown[2:], across))
    return on(sides, [u.ravel()] * 2, [v.ravel()] * 2)


def noisy(points, draw, noise=0.02e-3):
    """Points with normal noise in every coordinate [m]."""
    return points + noise * draw.normal(size=points.shape)


def turned(points, axis, angle):
    """Points turned about an axis [rad]."""
    return points @ Rotation.from_rotvec(angle * np.eye(3)[axis]).as_matrix().T


def strewn(points, draw):
    """With 3 % of the points up to a twentieth of the extent off."""
    off = draw.random(len(points)) < 0.03
    return points + off[:, None] * draw.uniform(-0.05, 0.05, points.shape) * np.ptp(points)


def uneven(points, draw):
    """Thinned to a tenth over one half."""
    first = points[:, 0] < np.median(points[:, 0])
    return points[first | (draw.random(len(points)) < 0.1)]


def elsewhere(points):
    """Points that have been moved."""
    return points @ PLACED[0].as_matrix().T + PLACED[1]


def start_beside(of):
    """A file of the true design with every law shaken by 3 %."""
    from bladewright.files.writing import write_design

    design = example(BROUGHT[of.machine])
    path, before = of.directory / "start.toml", design.parameters()
    while True:
        values = {k: v * (1.0 + 0.03 * of.draw.normal()) for k, v in before.items() if not k.startswith("ch")}
        try:
            write_design(design.changed(values), path)
        except DesignError:
            continue
        return str(path)


def _moved(of, *, started):
    options = ("--start", start_beside(of)) if started else ()
    return Case(points=elsewhere(rows(of.sides)), options=("--align", *options))


def _part(of, shown):
    return Case(points=noisy(rows(of.sides, shown=shown), of.draw), shown=shown)


VARIATIONS: dict[str, tuple[tuple[str, ...], Callable[[Truth], Case], str]] = {
    # name: machines, the case of one, and the words of the refusal that is right, or nothing
    "rows": ((*SPACE, "ls89"), lambda of: Case(points=rows(of.sides)), ""),
    "sections": (SPACE, lambda of: Case(points=rows(of.sides, 9)), ""),
    "scattered": ((*SPACE, "ls89"), lambda of: Case(points=scattered(of.sides, 5000, of.draw)), ""),
    "noise": ((*SPACE, "ls89"), lambda of: Case(points=noisy(rows(of.sides), of.draw)), ""),
    "outliers": ((*SPACE, "ls89"), lambda of: Case(points=strewn(noisy(rows(of.sides), of.draw), of.draw)), ""),
    "part": (SPACE, lambda of: _part(of, (0.0, 1.0, 0.2, 0.8)), ""),
    "open": (("aachen", "fan", "ls89"), lambda of: _part(of, (0.0, 0.9, 0.0, 1.0)), ""),
    "duplicated": (("aachen", "ls89"), lambda of: Case(points=np.repeat(noisy(rows(of.sides), of.draw), 3, 0)), ""),
    "uneven": (
        ("compressor", "fan", "ls89"),
        lambda of: Case(points=uneven(scattered(of.sides, 8000, of.draw), of.draw)),
        "",
    ),
    "axis-y": (
        ("aachen", "turbine"),
        lambda of: Case(points=noisy(rows(of.sides), of.draw)[:, [2, 0, 1]], options=("--columns", "z,x,y")),
        "",
    ),
    "axis-unsaid": (
        ("aachen", "turbine"),
        lambda of: Case(points=noisy(rows(of.sides), of.draw)[:, [1, 2, 0]]),
        "axis|columns",
    ),
    "align": (SPACE, lambda of: _moved(of, started=False), "axis"),
    "align-start": (SPACE, lambda of: _moved(of, started=True), ""),
    "annulus": (
        ("aachen", "impeller"),
        lambda of: Case(
            points=np.concatenate([turned(rows(of.sides, 11, 40), 0, t) for t in np.radians(np.arange(36) * 10)])
        ),
        "blades",
    ),
    "two": (
        ("aachen", "fan", "impeller"),
        lambda of: Case(points=np.concatenate([turned(rows(of.sides), 0, t) for t in (0.0, 0.35)])),
        "blades",
    ),
    "half": (
        ("aachen", "fan", "ls89"),
        lambda of: Case(points=rows(of.sides, shown=(0, 0.5, 0, 1))),
        "edge|half|whole",
    ),
    "suction": (
        ("aachen", "fan", "impeller", "ls89"),
        lambda of: Case(points=np.split(rows(of.sides), 2)[0]),
        "side",
    ),
    "inches": (("aachen", "ls89"), lambda of: Case(points=rows(of.sides), unit=0.0254), "unit"),
    "metres": (("aachen", "ls89"), lambda of: Case(points=rows(of.sides), unit=1.0), "unit"),
    "hundred": (("aachen", "ls89"), lambda of: Case(points=noisy(scattered(of.sides, 100, of.draw), of.draw)), ""),
    "many": (("aachen", "ls89"), lambda of: Case(points=noisy(scattered(of.sides, 200_000, of.draw), of.draw)), ""),
    "tolerance": (
        ("compressor", "fan", "impeller"),
        lambda of: Case(
            points=noisy(scattered(of.sides, 8000, of.draw), of.draw, 0.005e-3), options=("--tolerance", "0.05mm")
        ),
        "",
    ),
}
"""clouds as users bring them"""


def brought(machine, name, directory):
    """The cloud of a variation."""
    draw = np.random.default_rng(len(machine) + len(name))
    built = example(BROUGHT[machine]).build()
    sides = built.sides
    if machine == "ls89":
        of = built.sections[0].curves
        sides = of["upper"], of["lower"]
    case = VARIATIONS[name][1](Truth(machine=machine, sides=sides, draw=draw, directory=directory))
    others = scattered(sides, 8000, np.random.default_rng(7), case.shown)
    others = elsewhere(others) if "--align" in case.options else others
    # the command reads millimetres, whatever they are
    others = others * 1e-3 / case.unit
    return Cloud(points=draw.permutation(case.points), others=others, options=case.options, unit=case.unit)
