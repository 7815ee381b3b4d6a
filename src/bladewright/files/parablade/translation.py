"""From a ParaBlade configuration to the design of the unified family that comes nearest to its blade."""

from typing import Any

import numpy as np

from bladewright.blade.design.flow_path import Channel
from bladewright.blade.design.unified import UnifiedBlade
from bladewright.blade.flow_path.channel import transfinite_channel
from bladewright.designs import Law, Point
from bladewright.files.parablade.config import Config
from bladewright.files.parablade.sections import ParaBladePlanes, ParaBladeSections, mean_section, scaled_sections
from bladewright.files.parablade.thickness_fit import fitted_thickness, largest_edge_radii, least_thickness
from bladewright.nurbs.basis import Reals
from bladewright.section.laws import law_basis
from bladewright.section.unified import UnifiedSection
from bladewright.section.unified_sides import sample_places

MOST_CHANNEL_POINTS = 12
"""most control points of a curve"""
CHANNEL_TOLERANCE = 2e-5
"""distance of a curve from the one that is meant, of the channel's size, at which no more control points are added"""
_ALONG = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 101))) / 2.0


def channel_between_edges(config: Config, unit: float) -> tuple[Channel, float]:
    """The channel in a unit of `unit` metres, and the largest distance [m] of its curves from those that are meant."""
    shape = ParaBladeSections(config=config, v=_ALONG)
    places = shape.channel_places(np.broadcast_to([0.0, 1.0], (len(_ALONG), 2)))
    edges = shape.meridional(places)
    walls = []
    for end in (0, -1):
        at = ParaBladeSections(config=config, v=_ALONG[[end]])
        walls.append(at.meridional((places[end, 0] + _ALONG * (places[end, 1] - places[end, 0]))[None])[0])
    size = float(np.max(np.ptp(np.concatenate([edges.reshape(-1, 2), *walls]), axis=0)))
    curves, worst = {}, 0.0
    for name, points, axes in (
        ("leading_edge", edges[:, 0], ("leading",)),
        ("trailing_edge", edges[:, 1], ("trailing",)),
        ("hub", walls[0], ("hub",)),
        ("shroud", walls[1], ("shroud",)),
    ):
        inner = name in ("hub", "shroud")
        counts = [len(config.laws[f"{axis}_{axes[0]}"]) + (2 if inner else 0) for axis in "xz"]
        controls, error = _fitted_curve(points, max(2, *counts), CHANNEL_TOLERANCE * size)
        worst = max(worst, error)
        rows = controls[1:-1] if inner else controls
        curves[name] = tuple(Point(float(x), float(r)) for x, r in rows / unit)
    return Channel(**curves, degree=3), worst


def meridional_lengths(channel: Channel, unit: float, v: Reals) -> Reals:
    """Meridional lengths (m,) [m] of the channel at v (m,)."""
    nodes, weights = np.polynomial.legendre.leggauss(60)
    along, _ = transfinite_channel(channel, unit).slopes((nodes + 1.0) / 2.0, v)
    return np.sqrt(np.sum(np.real(along) ** 2, axis=-1)) @ weights / 2.0


def _fitted_curve(points: Reals, count: int, close: float) -> tuple[Reals, float]:
    """Control points of the spline that is nearest to points (101, 2) at their parameters, its ends on theirs."""
    while True:
        rows = law_basis(count, _ALONG)
        ends = rows[:, [0, -1]] @ points[[0, -1]]
        inner = np.linalg.lstsq(rows[:, 1:-1], points - ends, rcond=None)[0] if count > 2 else np.empty((0, 2))
        controls = np.concatenate([points[:1], inner, points[-1:]])
        error = float(np.sqrt(np.max(np.sum((rows @ controls - points) ** 2, axis=-1))))
        if error <= close or count == MOST_CHANNEL_POINTS:
            return controls, error
        count += 1


UNIT = 1e-3
"""metres in a design's millimetre"""
SAMPLES = 16
STATIONS = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 13))) / 2.0
"""places along the span at which the sections are matched"""
CHORDWISE = (8, 10, 12, 14, 16)
"""numbers of control points of a thickness law that are tried: ParaBlade's own has 8, the edge radii at its ends"""
SIDE_TOLERANCE = 5e-4
"""distance of the sides, of the meridional length, at which no more control points are added"""
ANGLE_TOLERANCE = 0.02
"""deviation of a law [deg] at which no more control points are added"""
TANGENT_TOLERANCE = 2e-3
"""deviation of a law of tangents, of itself, at which no more control points are added"""
EXTRA_CONTROL_POINTS = 3
"""control points that a law may be given beyond ParaBlade's"""
RADIUS_REDUCTION = 0.95
"""part of the largest radius that an edge is given where its thickness cannot hold ParaBlade's"""

Laws = dict[str, Any]


def section_of(config: Config, name: str, chordwise: int | None) -> tuple[UnifiedSection, list[str]]:
    """The section of a configuration in two dimensions, and what was changed, each a sentence."""
    planes, start, extent = mean_section(config)
    laws, notes = _laws(config, planes, chordwise)
    design = UnifiedSection(
        name=name,
        length_unit="mm",
        leading_edge_x=float(start[0]) / UNIT,
        leading_edge_y=float(start[1]) / UNIT,
        axial_chord=extent / UNIT,
        samples=SAMPLES,
        **laws,
    )
    return design, notes


def blade_of(config: Config, name: str, chordwise: int | None) -> tuple[UnifiedBlade, list[str]]:
    """The blade of a configuration in three dimensions, and what was changed, each a sentence."""
    channel, off = channel_between_edges(config, UNIT)
    shape = ParaBladeSections(config=config, v=STATIONS)
    lengths = meridional_lengths(channel, UNIT, STATIONS)
    laws, notes = _laws(config, scaled_sections(shape, shape.lengths / lengths), chordwise)
    notes.insert(
        0,
        "the channel is cut where the camber lines begin and end, as ParaBlade's is filled from nose to nose; its "
        f"curves lie within {off * 1e3:.2g} mm of those",
    )
    y = shape.law("y_leading")
    count = len(config.laws["y_leading"])
    if config.annular:
        at = shape.channel_places(np.zeros((len(STATIONS), 1)))
        radius = shape.meridional(at)[:, 0, 1]
        place, _ = _law(np.degrees(y / radius), STATIONS, count, ANGLE_TOLERANCE / 10.0)
        own: Laws = {"leading_edge_theta": place}
    else:
        place, _ = _law(y / UNIT, STATIONS, count, float(np.max(lengths)) / UNIT * SIDE_TOLERANCE)
        own = {"leading_edge_y": place}
    design = UnifiedBlade(
        name=name,
        length_unit="mm",
        arrangement="annular" if config.annular else "linear",
        blade_count=max(config.blades, 1) if config.annular else None,
        pitch=None if config.annular else float(np.max(lengths)) / UNIT,
        channel=channel,
        mapping="paper",
        samples=SAMPLES,
        **own,
        **laws,
    )
    return design, notes


def _laws(config: Config, planes: ParaBladePlanes, wanted: int | None) -> tuple[Laws, list[str]]:
    """Angles, tangents, radii and thicknesses of sections, and what was changed."""
    notes: list[str] = []
    line, v = planes.camber, planes.v
    first, last = line[:, 1] - line[:, 0], line[:, 3] - line[:, 2]
    found: Laws = {}
    for name, key, values, close in (
        ("stagger", "stagger", np.degrees(np.arctan(line[:, 3, 1])), ANGLE_TOLERANCE),
        ("metal_angle_in", "theta_in", np.degrees(np.arctan2(first[:, 1], first[:, 0])), ANGLE_TOLERANCE),
        ("metal_angle_out", "theta_out", np.degrees(np.arctan2(last[:, 1], last[:, 0])), ANGLE_TOLERANCE),
        ("tangent_in", "dist_in", np.sqrt(np.sum(first**2, axis=-1)), None),
        ("tangent_out", "dist_out", np.sqrt(np.sum(last**2, axis=-1)), None),
    ):
        limit = TANGENT_TOLERANCE * float(np.mean(values)) if close is None else close
        found[name], count = _law(values, v, len(config.laws[key]), limit)
        if count > len(config.laws[key]):
            notes.append(f"{name} has {count} control points, where ParaBlade has {len(config.laws[key])}")
        if name.startswith("tangent") and np.max(values) > 1.0:
            notes.append(f"{name} is lowered from {np.max(values):.3g} to 1: the camber would turn back")
            found[name] = _clipped(found[name], 1e-3, 1.0)
    places = sample_places(SAMPLES, 1.0)
    spans = {side_name: _spanwise(config, side_name) for side_name in ("upper", "lower")}
    thickness: dict[str, Reals] = {}
    for chordwise in CHORDWISE if wanted is None else (wanted,):
        off = 0.0
        for side_name, target in (("upper", planes.upper), ("lower", planes.lower)):
            upper = side_name == "upper"
            least = least_thickness(chordwise, spans[side_name], planes.radii, v, places)
            law, distance = fitted_thickness(line, planes.radii, target, least, v, places, upper=upper)
            thickness[side_name] = law
            off = max(off, distance)
        if off <= SIDE_TOLERANCE:
            break
    notes.append(
        f"the sides are quartic, ParaBlade's cubic: their thickness laws have {chordwise} control points along the "
        f"chord, matched within {100.0 * off:.2g} % of the meridional length"
    )
    for side_name, law in thickness.items():
        found[f"thickness_{side_name}"] = tuple(_plain(row) for row in law)
    found.update(_radii(config, planes, thickness, places, notes))
    return found, notes


def _radii(
    config: Config, planes: ParaBladePlanes, thickness: dict[str, Reals], places: Reals, notes: list[str]
) -> Laws:
    """Laws of the edge radii, lowered where the thickness cannot hold them."""
    fine = np.linspace(0.0, 1.0, 101) if len(planes.v) > 1 else planes.v
    camber = _interpolated(planes.camber, planes.v, fine)
    inner = places[2:-2]
    values = [law_basis(law.shape[1], fine) @ law.T @ law_basis(law.shape[0], inner).T for law in thickness.values()]
    most = largest_edge_radii(camber, (values[0], values[1]), places)
    found: Laws = {}
    for name, key, radii, limit in zip(
        ("leading_edge_radius", "trailing_edge_radius"), ("radius_in", "radius_out"), planes.radii, most, strict=True
    ):
        count = len(config.laws[key])
        rows = law_basis(count, fine)
        wanted = _interpolated(radii, planes.v, fine)
        law = np.linalg.lstsq(rows, wanted, rcond=None)[0]
        law = np.clip(law, 0.8 * np.min(radii), 0.999)
        changed = False
        for _ in range(60):
            over = rows @ law > limit
            if not np.any(over):
                break
            changed = True
            worst = int(np.argmax(rows @ law / np.maximum(limit, 1e-12)))
            law = np.where(rows[worst] > 0.2, law * RADIUS_REDUCTION, law)
        if changed:
            notes.append(f"{name} is lowered where the thickness beside it cannot hold ParaBlade's {key}")
        found[name] = _plain(law)
    return found


def _law(values: Reals, v: Reals, count: int, close: float) -> tuple[Law, int]:
    """Control points of a law through values (m,), and how many: more than `count` where it is not close otherwise."""
    if len(v) == 1:
        return float(values[0]), 1
    for number in range(count, count + EXTRA_CONTROL_POINTS + 1):
        rows = law_basis(number, v)
        law = np.linalg.lstsq(rows, values, rcond=None)[0]
        if np.max(np.abs(rows @ law - values)) <= close:
            break
    return _plain(law), number


def _spanwise(config: Config, name: str) -> int:
    if config.dimensions == 2:
        return 1
    # the edge radii are the ends of ParaBlade's thickness laws, and vary along the span with them
    keys = ("radius_in", *(f"thickness_{name}_{i}" for i in range(1, 7)), "radius_out")
    return max(len(config.laws[key]) for key in keys)


def _interpolated(values: Reals, v: Reals, fine: Reals) -> Reals:
    if len(v) == 1:
        return values
    from scipy.interpolate import make_interp_spline

    return np.asarray(make_interp_spline(v, values, k=3)(fine))


def _plain(values: Any) -> Law:
    return float(values[0]) if len(values) == 1 else tuple(float(each) for each in values)


def _clipped(law: Law, low: float, high: float) -> Law:
    values = np.clip(np.atleast_1d(np.array(law, dtype=np.float64)), low, high)
    return _plain(values)
