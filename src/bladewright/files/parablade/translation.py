"""From a ParaBlade configuration to the design of the unified family that comes nearest to its blade.

ParaBlade's sections fill the channel from nose to nose, those of the unified family from the beginning of the camber
line to its end. So the channel is cut at the ends of the camber lines. Where the cut is at the same u along the span,
its transfinite interpolation keeps its form.
"""

from typing import Any

import numpy as np

from bladewright.blade.design.flow_path import Channel
from bladewright.blade.design.unified import UnifiedBlade
from bladewright.blade.flow_path.channel import transfinite_channel
from bladewright.designs import Law, Point
from bladewright.files.parablade.config import Config
from bladewright.files.parablade.sections import NormalisedSections, ParaBladeSections, mean_section, scaled_sections
from bladewright.files.parablade.thickness_fit import fitted_thickness, largest_edge_radii, least_thickness
from bladewright.nurbs.basis import Reals
from bladewright.section.laws import law_basis
from bladewright.section.unified import UnifiedSection
from bladewright.section.unified_sides import sample_places

MOST_CHANNEL_POINTS = 12
"""Most control points of a curve of the channel. A curve of more would follow the cut's last details, and could no
longer be changed by hand; the distance that is left is reported."""
CHANNEL_TOLERANCE = 2e-5
"""Distance of a channel curve from ParaBlade's, as a fraction of the channel's size, at which no more control points
are added: 2 micrometres on 100 mm, well below what is machined."""
UNIT = 1e-3
"""[m] A millimetre, in which imported designs have their lengths."""
SAMPLES = 16
"""Points along the chord at which the imported design applies its thickness: more than ParaBlade's 10, so that the
quartic sides of the unified family can follow its cubic ones."""
SPAN_STATIONS = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 13))) / 2.0
"""Span fractions at which the sections are fitted: cosine spacing, more than ParaBlade's laws usually have control
points."""
CHORDWISE_COUNTS = (8, 10, 12, 14, 16)
"""Numbers of control points of a thickness law that are tried in turn. ParaBlade's own law has 8, with the edge radii
at its ends; more than there are samples could not be determined."""
SIDE_TOLERANCE = 5e-4
"""Distance of the sides from ParaBlade's, as a fraction of the meridional length, at which no more control points are
added. The distance that is reached is reported."""
ANGLE_TOLERANCE = 0.02
"""[deg] Deviation of an angle's law from ParaBlade's at which no more control points are added: well below a difference
that matters to the flow."""
TANGENT_TOLERANCE = 2e-3
"""Relative deviation of a tangent length's law at which no more control points are added; looser than for angles, since
a tangent's length moves the camber line less than its direction does."""
EXTRA_CONTROL_POINTS = 3
"""Most control points that a law is given beyond ParaBlade's, so that the import stays a design of few parameters."""
RADIUS_REDUCTION = 0.95
"""Factor by which the edge radius is reduced, repeatedly, where the thickness next to the edge cannot hold
ParaBlade's."""

Laws = dict[str, Any]
"""fields of a design by name"""

_CHANNEL_STATIONS = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 101))) / 2.0


def channel_between_edges(config: Config, unit: float) -> tuple[Channel, float]:
    """The channel between the ends of the camber lines, in units of `unit` metres, and its largest error [m]."""
    sections = ParaBladeSections(config=config, v=_CHANNEL_STATIONS)
    places = sections.channel_places(np.broadcast_to([0.0, 1.0], (len(_CHANNEL_STATIONS), 2)))
    edges = sections.meridional(places)
    walls = []
    for end in (0, -1):
        at = ParaBladeSections(config=config, v=_CHANNEL_STATIONS[[end]])
        walls.append(at.meridional((places[end, 0] + _CHANNEL_STATIONS * (places[end, 1] - places[end, 0]))[None])[0])
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
    """Control points of the spline that fits points (101, 2) with least squares and passes through both ends."""
    while True:
        rows = law_basis(count, _CHANNEL_STATIONS)
        ends = rows[:, [0, -1]] @ points[[0, -1]]
        inner = np.linalg.lstsq(rows[:, 1:-1], points - ends, rcond=None)[0] if count > 2 else np.empty((0, 2))
        controls = np.concatenate([points[:1], inner, points[-1:]])
        error = float(np.sqrt(np.max(np.sum((rows @ controls - points) ** 2, axis=-1))))
        if error <= close or count == MOST_CHANNEL_POINTS:
            return controls, error
        count += 1


def section_of(config: Config, name: str, chordwise: int | None) -> tuple[UnifiedSection, list[str]]:
    """The section of a configuration in two dimensions, and what was changed, each a sentence."""
    normalised, start, extent = mean_section(config)
    laws, notes = _laws(config, normalised, chordwise)
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
    channel, largest_distance = channel_between_edges(config, UNIT)
    sections = ParaBladeSections(config=config, v=SPAN_STATIONS)
    lengths = meridional_lengths(channel, UNIT, SPAN_STATIONS)
    laws, notes = _laws(config, scaled_sections(sections, sections.lengths / lengths), chordwise)
    notes.insert(
        0,
        "the channel is cut where the camber lines begin and end, as ParaBlade's is filled from nose to nose; its "
        f"curves lie within {largest_distance * 1e3:.2g} mm of those",
    )
    y = sections.law("y_leading")
    count = len(config.laws["y_leading"])
    if config.annular:
        at = sections.channel_places(np.zeros((len(SPAN_STATIONS), 1)))
        radius = sections.meridional(at)[:, 0, 1]
        place, _ = _law(np.degrees(y / radius), SPAN_STATIONS, count, ANGLE_TOLERANCE / 10.0)
        own: Laws = {"leading_edge_theta": place}
    else:
        place, _ = _law(y / UNIT, SPAN_STATIONS, count, float(np.max(lengths)) / UNIT * SIDE_TOLERANCE)
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


def _laws(config: Config, normalised: NormalisedSections, wanted: int | None) -> tuple[Laws, list[str]]:
    """Laws of angles, tangent lengths, edge radii and thicknesses, and what was changed, each a sentence."""
    notes: list[str] = []
    line, v = normalised.camber, normalised.v
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
    for chordwise in CHORDWISE_COUNTS if wanted is None else (wanted,):
        largest_distance = 0.0
        for side_name, target in (("upper", normalised.upper), ("lower", normalised.lower)):
            upper = side_name == "upper"
            least = least_thickness(chordwise, spans[side_name], normalised.radii, v, places)
            law, distance = fitted_thickness(line, normalised.radii, target, least, v, places, upper=upper)
            thickness[side_name] = law
            largest_distance = max(largest_distance, distance)
        if largest_distance <= SIDE_TOLERANCE:
            break
    notes.append(
        f"the sides are quartic, ParaBlade's cubic: their thickness laws have {chordwise} control points along the "
        f"chord, matched within {100.0 * largest_distance:.2g} % of the meridional length"
    )
    for side_name, law in thickness.items():
        found[f"thickness_{side_name}"] = tuple(_plain(row) for row in law)
    found.update(_radii(config, normalised, thickness, places, notes))
    return found, notes


def _radii(
    config: Config, normalised: NormalisedSections, thickness: dict[str, Reals], places: Reals, notes: list[str]
) -> Laws:
    """Laws of the edge radii, reduced where the thickness next to the edge cannot hold them."""
    fine = np.linspace(0.0, 1.0, 101) if len(normalised.v) > 1 else normalised.v
    camber = _interpolated(normalised.camber, normalised.v, fine)
    inner = places[2:-2]
    values = [law_basis(law.shape[1], fine) @ law.T @ law_basis(law.shape[0], inner).T for law in thickness.values()]
    most = largest_edge_radii(camber, (values[0], values[1]), places)
    found: Laws = {}
    for name, key, radii, limit in zip(
        ("leading_edge_radius", "trailing_edge_radius"),
        ("radius_in", "radius_out"),
        normalised.radii,
        most,
        strict=True,
    ):
        count = len(config.laws[key])
        rows = law_basis(count, fine)
        wanted = _interpolated(radii, normalised.v, fine)
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
    """Control points of a law fitted to values (m,), and their number: `count`, or more where it deviates too much."""
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
