"""A blade drawn at random that becomes a part: with fillets, cuts, a disc, a shroud ring and a density.

The blade without them is the first that can be built of those drawn in turn, unified or from sections. Sizes reach from
tiny to too large, and some of the parts do not fit the blade: a cut beside it, a fillet at a gap, a disc in a cascade.
"""

from functools import lru_cache

import numpy as np
import random_blades
import random_sections

from bladewright.blade.design.cut import AtRadius, AtX, Cut
from bladewright.blade.design.disc import Disc, Outline
from bladewright.blade.design.fillet import Fillet, FilletRadii
from bladewright.blade.design.meridional_curve import ControlPolygon, ThroughPoints
from bladewright.errors import DesignError

PARTS = {"hub_fillet": 0.6, "shroud_fillet": 0.25, "cut": 0.35, "disc": 0.35, "shroud_ring": 0.08, "density": 0.5}
"""how often each is drawn"""
TRIES = 40
"""most blades that are drawn for one that can be built"""


def random_design(seed):
    """The design of a seed; raises DesignError where its numbers alone are refused."""
    blade = _base(seed)
    draw = np.random.default_rng([seed, 6])
    names = [name for name in random_parts(seed) if _fits(blade.design, name) or draw.random() < 0.1]
    parts = {name: DRAWN[name](draw, blade) for name in names}
    return blade.design.changed(parts) if parts else blade.design


def random_parts(seed):
    """Which parts the blade of a seed gets."""
    draw = np.random.default_rng([seed, 4])
    return [name for name, share in PARTS.items() if draw.random() < share]


def random_shape(seed):
    """The same in words."""
    return " + ".join(name.replace("_", " ") for name in random_parts(seed) if name != "density") or "blade"


@lru_cache(maxsize=1)
def _base(seed):
    """The blade that gets the parts."""
    draw = np.random.default_rng([seed, 5])
    kind = random_blades if draw.random() < 0.5 else random_sections
    for _ in range(TRIES):
        try:
            return kind.random_design(int(draw.integers(1_000_000))).build()
        except DesignError:
            continue
    raise DesignError(f"none of {TRIES} blades of seed {seed} can be built: their channel or sections are refused")


def _fits(design, name):
    """Whether a blade may have a part: one stands on its wall, and discs carry annular rows."""
    end = 0 if name in {"hub_fillet", "disc"} else 1
    on_wall = name in {"cut", "density"} or design.ends[end] != "tip"
    return on_wall and (design.arrangement == "annular" or name not in {"disc", "shroud_ring"})


def _fillet(draw, blade):
    """A fillet of any kind, from a thousandth to a tenth of the chord."""
    size = _chord(blade) * np.exp(draw.uniform(np.log(1e-3), np.log(0.1)))

    def near(spread=2.0):
        return float(size * np.exp(draw.uniform(-1.0, 1.0) * np.log(spread)))

    kind = str(draw.choice(["radius", "radius", "ellipse", "curvature"]))
    if kind == "ellipse":
        return Fillet(kind=kind, on_blade=near(), on_wall=near())
    choice = draw.random()
    if choice < 0.6:
        return Fillet(kind=kind, radius=near(1.0))
    if choice < 0.8:
        return Fillet(kind=kind, radius=tuple(near() for _ in range(draw.integers(2, 5))))
    sides = ("suction_side", "pressure_side") if draw.random() < 0.3 else ("upper", "lower")
    return Fillet(kind=kind, radius=FilletRadii(**{name: near() for name in ("leading_edge", "trailing_edge", *sides)}))


def _cut(draw, blade):
    """Cuts of one to four sides, the most of them within the blade."""
    names = [name for name in ("hub", "tip", "leading_edge", "trailing_edge") if draw.random() < 0.4]
    return Cut(**{name: _cut_curve(draw, blade, name) for name in names or ["trailing_edge"]})


def _cut_curve(draw, blade, name):
    """Where a blade is cut: along a line between two of its borders, or at that line's mean x or radius."""
    share = draw.uniform(0.03, 0.3) if draw.random() < 0.9 else draw.uniform(-0.1, 0.03)
    share = share if name in {"hub", "leading_edge"} else 1.0 - share
    places = np.linspace(0.05, 0.95, int(draw.integers(2, 6)))
    share = share + draw.uniform(-0.05, 0.05) * (places - 0.5)
    borders = [
        _meridional(blade, *((places, end) if name in {"hub", "tip"} else (end, places)))
        for end in (np.zeros(len(places)), np.ones(len(places)))
    ]
    points = borders[0] + share[:, None] * (borders[1] - borders[0])
    ends = [0.4 * (points[i] - points[j]) / (places[1] - places[0]) for i, j in ((0, 1), (-1, -2))]
    points = np.concatenate([points[:1] + ends[0], points, points[-1:] + ends[1]])
    (x, r), spread = points.mean(axis=0), np.ptp(points, axis=0)
    if draw.random() < 0.8 and min(spread) < 0.15 * max(spread):
        return AtX(x=float(x)) if spread[0] < spread[1] or r <= 0.0 else AtRadius(radius=float(r))
    pairs = random_blades.pairs(points)
    return ThroughPoints(points=pairs) if draw.random() < 0.6 else ControlPolygon(control_points=pairs)


def _carrier(draw, blade, end):
    """A thin rim, or an outline between two places of the wall up- and downstream of the blade."""
    length = _length(blade)
    depth = length * np.exp(draw.uniform(np.log(0.02), np.log(0.7)))
    if draw.random() < 0.5:
        far = {name: float(length * draw.uniform(0.02, 0.3)) for name in ("upstream", "downstream")}
        return Disc(thickness=float(depth), **(far if draw.random() < 0.5 else {}))
    wall = blade.surfaces[blade.design.ends[end]].revolution
    if wall is None:
        return Disc(thickness=float(depth))
    low, high = wall.meridian.domain
    s = np.array([low + 0.02 * (high - low), high - 0.02 * (high - low)])
    ends, slopes = np.real(wall.meridian(s)) / blade.design.metre, np.real(wall.meridian.derivative(s))
    side = -1.0 if end == 0 else 1.0
    away = side * np.stack([-slopes[:, 1], slopes[:, 0]], axis=-1) / np.hypot(*slopes.T)[:, None]
    inner = ends + away * depth * draw.uniform(0.6, 1.4, (2, 1)) + 0.1 * depth * draw.normal(size=(2, 2))
    off = 0.05 * length if draw.random() < 0.1 else 0.0
    if draw.random() < 0.95:
        inner[:, 1] = np.maximum(inner[:, 1], 0.1 * ends[:, 1])
    points = np.stack([ends[0] + off * away[0], *inner, ends[1]])
    radii = tuple(map(float, depth * draw.uniform(0.0, 0.4, 2))) if draw.random() < 0.5 else ()
    return Disc(outline=Outline(points=random_blades.pairs(points), radii=radii))


def _chord(blade):
    """From edge to edge at mid-span, in the design's unit."""
    points = [np.real(blade.surfaces["upper"](u, 0.5)) for u in (0.0, 1.0)]
    return float(np.sqrt(np.sum((points[1] - points[0]) ** 2))) / blade.design.metre


def _length(blade):
    """The same in the meridional plane."""
    first, last = _meridional(blade, np.array([0.0, 1.0]), np.array([0.5, 0.5]))
    return float(np.sqrt(np.sum((last - first) ** 2)))


def _meridional(blade, u, v):
    """(x, r) (k, 2) of the upper side in the design's unit."""
    points = np.real(blade.surfaces["upper"](u, v))
    radius = np.hypot(points[:, 1], points[:, 2]) if blade.design.arrangement == "annular" else points[:, 2]
    return np.stack([points[:, 0], radius], axis=-1) / blade.design.metre


DRAWN = {
    "hub_fillet": _fillet,
    "shroud_fillet": _fillet,
    "cut": _cut,
    "disc": lambda draw, blade: _carrier(draw, blade, 0),
    "shroud_ring": lambda draw, blade: _carrier(draw, blade, 1),
    "density": lambda draw, _: float(draw.uniform(1000.0, 9000.0)),
}
"""what draws each part"""
