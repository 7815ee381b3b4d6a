"""What a design builds, as nested figures for JSON and as lines to read."""

from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from typing import Any

from bladewright.cli.law_remarks import law_data, law_rows
from bladewright.cli.outcome import jsonable

Rows = list[tuple[str, str]]
"""Names and values of a table."""
PASSAGE_LIMITS = {"ring_filled": 1e-6, "walls": 1e-7}
"""Largest errors of a passage: its volume and the blades' against the ring's, as a fraction of the ring's volume; and
the distance of its walls from hub and shroud, in chords, which is what a blade's own ends must keep."""
SMOOTHNESS_SPANS = (0.0, 0.5, 1.0)
"""Span fractions at which smoothness is reported."""
LINE_NAMES = {"upper": "upper side", "lower": "lower side", "camber": "camber line"}
"""What the lines of a section are called in the table."""
QUANTITY_NAMES = {"curvature": "curvature", "slope": "its slope"}
"""What is compared at the joints of a line, and its words in the table."""
_POWERS = {
    "volume": 3,
    "area": 2,
    "areas": 2,
    "centroid": 1,
    "inertia": 5,
    "camber_length": 1,
    "perimeter": 1,
    "pitch": 1,
    "maximum_thickness": 1,
    "maximum_camber": 1,
    "edge_radii": 1,
}
"""Power of a length that a property has as its unit."""
COMPONENTS = {
    "centroid": ("x", "y", "z"),
    "inertia": ("Ixx", "Ixy", "Ixz", "Iyx", "Iyy", "Iyz", "Izx", "Izy", "Izz"),
    "edge_radii": ("leading", "trailing"),
}
"""What the figures of a property are called."""
_WORDS = {
    "area": "surface area",
    "areas": "face areas",
    "inertia": "inertia about centroid",
    "openness": "faces close up to",
    "centroid": "centroid",
    "maximum_thickness_at": "where, camber's u",
}
"""What a property is called in the table, where its name does not say it."""
_CHECKS = {
    "metal_angle_at_walls": ("metal angles at hub and shroud", "deg off the design"),
    "metal_angle_between": ("metal angles between them", "deg off the design"),
    "edge_radius": ("edge radii", "of the radius off"),
    "edge_tangent_planes": ("tangents at the edges", "rad between the sides"),
    "edge_curvatures": ("curvature at the edges", "of the largest curvature from side to side"),
    "stream_surfaces": ("stream surfaces", "chords off"),
    "walls": ("ends on their walls", "chords off"),
    "surface": ("sides", "chords off the exact blade"),
    "clearance": ("clearance", "chords off"),
    "sections": ("given sections", "chords off"),
    "twist": ("twist", "deg along a straight line"),
    "ring_filled": ("volume of the annulus", "of it not filled by passages and blades"),
}
"""What is checked, in words, and what its figure counts."""


def summary_data(design: Any, built: Any) -> dict[str, Any]:
    """Name, size [m], error, properties [m], checks and poles of the blade, section or passage of a design."""
    from bladewright.files.families import family_of

    entities = "surfaces" if built.dimension == 3 else "curves"
    data = {
        "name": design.name,
        "family": family_of(design),
        "parameters": len(design.parameters()),
        "length_unit": design.length_unit,
        "chord_m": getattr(built, "chord", None),
        "error": getattr(built, "error", None),
        "properties": _record(getattr(built, "properties", built)),
        "laws": law_data(design) or None,
        "promises": _record(getattr(built, "conformance", None)),
        entities: {name: _poles(entity) for name, entity in getattr(built, entities).items()},
    }
    return {key: jsonable(value) for key, value in data.items() if value is not None}


def passage_data(design: Any, built: Any) -> dict[str, Any]:
    """The figures of `summary_data`, and those of a passage alone: ring, extents, Jacobians, and errors with limits."""
    import numpy as np

    if built.dimension == 2:
        area = {"area": built.area, "pitch": np.ptp(np.real(built.curves["inlet"].control_points[:, 1]))}
        return {**summary_data(design, built), "name": f"{design.name}-passage", "properties": jsonable(area)}
    errors = {"ring_filled": abs(built.ring_error), "walls": built.wall_error}
    jacobians = {name: dict(zip(("share", "u", "v"), least, strict=True)) for name, least in built.folds.items()}
    kept = all(errors[name] <= limit for name, limit in PASSAGE_LIMITS.items())
    own = {
        "name": built.name,
        "ring_m3": np.real(built.ring),
        "upstream": built.knots.upstream,
        "downstream": built.knots.downstream,
        "meridional_length_m": built.knots.length,
        "walls": built.knots.walls,
        "least_jacobian": jacobians,
        "promises": {**errors, "limits": PASSAGE_LIMITS, "kept": kept},
    }
    return {**summary_data(design, built), **{key: jsonable(value) for key, value in own.items()}}


def part_data(design: Any, built: Any) -> dict[str, Any]:
    """The figures of a row, a sector or a wheel: number of blades and faces, properties, and the blade's checks."""
    data = summary_data(design, built)
    del data["surfaces"], data["properties"]["areas"]
    return {
        **data,
        "name": built.name,
        "blades": int(design.blade_count or len(getattr(built, "placements", ()))),
        "faces": len(built.surfaces),
        "surfaces": {},
        "promises": jsonable(_record(built.blade.conformance)),
    }


def smoothness_data(built: Any) -> list[dict[str, Any]]:
    """Curvature and its slope with their jumps, by line, of the sections at SMOOTHNESS_SPANS, or of one section."""
    import numpy as np

    from bladewright.section.smoothness import smoothness

    if built.dimension == 2:
        return [{"span": built.span, "chord_m": float(np.real(built.chord)), **smoothness(built).to_dict()}]
    spans = built.exact.shown_spans(SMOOTHNESS_SPANS)
    chords = [float(np.real(built.section(v).chord)) for v in spans]
    return [{"span": v, "chord_m": c, **built.smoothness(v).to_dict()} for v, c in zip(spans, chords, strict=True)]


def summary_text(data: dict[str, Any], more: Sequence[tuple[str, str]] = ()) -> str:
    """The same figures to read, in the design's unit of length: size and error, properties, poles, and checks.

    `more` are names and values that go before the poles.
    """
    unit = data["length_unit"]
    metre = 1.0 / _metres(unit)
    in_space = "surfaces" in data
    words = "mean chord" if in_space else "chord"
    rows = [(words, f"{data['chord_m'] * metre:.6g} {unit}")] if "chord_m" in data else []
    rows += [(name, str(data[name])) for name in ("blades", "faces") if name in data]
    if "error" in data:
        size = f" ({data['error'] * data['chord_m'] * metre:.2g} {unit})" if "chord_m" in data else ""
        rows.append(("off the exact blade", f"{data['error']:.2g} of the chord at most{size}"))
    for name, value in data["properties"].items():
        if name not in ("chord", "span"):
            words = _WORDS.get(name, name.replace("_", " ")) if in_space or name != "area" else "area"
            rows.append((words.removesuffix(" deg"), _property(name, value, list(data.get("surfaces", [])), unit)))
    rows += more
    for name, entity in data.get("surfaces", data.get("curves", {})).items():
        poles, degree = (" x ".join(map(str, entity[key])) for key in ("poles", "degree"))
        rows.append((name, f"{poles} control points of degree {degree}{', rational' if entity['rational'] else ''}"))
    rows += [*law_rows(data.get("laws", {})), *_check_rows(data.get("promises", {}))]
    width = max((len(name) for name, _ in rows), default=0)
    head = f"{data['name']}: {data['family']}, {data['parameters']} parameters"
    return "\n".join([head, *(f"  {name:<{width}}  {value}" for name, value in rows)])


def _property(name: str, value: Any, faces: list[str], unit: str) -> str:
    """The value of a property with its unit, and its components or faces by name."""
    power = _POWERS.get(name, 0)
    shown, scale = "", _metres(unit) ** -power
    if power:
        shown = f" {unit}" if power == 1 else f" {unit}{power}"
    if name.endswith("_deg"):
        shown = " deg"
    names = faces if name == "areas" else COMPONENTS.get(name, ())
    if name == "openness":
        shown = " of their area"
    figures = _flat(value)
    if names and len(figures) <= len(names):
        parts = [f"{part} {_figure(each, scale)}" for part, each in zip(names, figures, strict=False)]
        # the tensor is symmetric
        kept = [part for part in parts if not part.startswith(("Iyx", "Izx", "Izy"))]
        return ", ".join(kept) + shown
    return " ".join(_figure(each, scale) for each in figures) + shown


def _flat(value: Any) -> list[Any]:
    return [each for item in value for each in _flat(item)] if isinstance(value, list) else [value]


def passage_rows(data: Mapping[str, Any]) -> Rows:
    """Annulus, extents and least Jacobian of a passage, to read; nothing for another body."""
    if "ring_m3" not in data:
        return []
    unit = data["length_unit"]
    length = f"{data['meridional_length_m'] / _metres(unit):.6g} {unit}"
    rows = [("whole annulus", f"{data['ring_m3'] / _metres(unit) ** 3:.6g} {unit}3")]
    rows += [(name, f"{data[name]:.4g} meridional lengths of {length}") for name in ("upstream", "downstream")]
    if not data["least_jacobian"]:
        return [*rows, ("hub and shroud", "trimmed faces of their exact surfaces, which have no patches to fold")]
    name, least = min(data["least_jacobian"].items(), key=lambda each: each[1]["share"])
    text = f"{least['share']:.2g} of its median, on {name} at u = {least['u']:.4g}, v = {least['v']:.4g}"
    return [*rows, ("least Jacobian", text)]


def smoothness_rows(sections: list[dict[str, Any]], unit: str) -> Rows:
    """What is continuous on every section, and the largest jump of what is not in its own unit, to read."""
    return [(name, _smoothness_text(sections, line, unit)) for line, name in LINE_NAMES.items() if sections]


def broken_promises(data: dict[str, Any]) -> tuple[str, ...]:
    """A line for every check that failed."""
    promises = data.get("promises", {})
    return tuple(
        f"{data['name']}: the check of {_CHECKS[name][0]} ('{name}') failed: {_check_text(name, promises[name], limit)}"
        for name, limit in promises.get("limits", {}).items()
        if not _kept(promises[name], limit)
    )


def _check_rows(promises: Mapping[str, Any]) -> Rows:
    rows, limits = [], promises.get("limits", {})
    if limits:
        failed = sum(not _kept(promises[name], limit) for name, limit in limits.items())
        rows.append(("checks", f"{failed} of {len(limits)} FAILED:" if failed else f"all {len(limits)} passed:"))
    for name, limit in limits.items():
        text = _check_text(name, promises[name], limit)
        rows.append((_CHECKS[name][0], text + ("" if _kept(promises[name], limit) else ": FAILED")))
    if promises.get("twist") is not None and "twist" not in limits:
        cut = f"a flank cutter cuts {promises['flank_cut']:.2g} of its radius into it"
        rows.append(("twist", f"{promises['twist']:.3g} deg along the line at u = {promises['twist_at']:.3g}: {cut}"))
    return rows


def _check_text(name: str, value: float | None, limit: float) -> str:
    return f"{'unknown' if value is None else f'{value:.2g}'} {_CHECKS[name][1]}, at most {limit:.2g} allowed"


def _kept(value: float | None, limit: float) -> bool:
    return value is not None and value <= limit


def _smoothness_text(sections: list[dict[str, Any]], line: str, unit: str) -> str:
    parts = []
    for order, (quantity, name) in enumerate(QUANTITY_NAMES.items(), start=1):
        if all(each[line][f"{quantity}_continuous"] for each in sections):
            parts.append(f"{name} continuous")
            continue
        per = f"1/{unit}" if order == 1 else f"1/{unit}{order}"
        jumps = [
            (max(joint[quantity]) - min(joint[quantity]), joint["at"], each)
            for each in sections
            for joint in each[line]["joints"]
            if each[line][f"{quantity}_jump_of_largest"] > 0.0 and len(joint[quantity]) > 1
        ]
        if not jumps:
            parts.append(f"{name} with it")
            continue
        worst = max(jumps, key=lambda jump: jump[0] / jump[2]["chord_m"] ** order)
        size = worst[0] * (_metres(unit) / worst[2]["chord_m"]) ** order
        where = f"at {100.0 * worst[1]:.3g} % of its length"
        where += f", span {worst[2]['span']:.3g}" if len(sections) > 1 else ""
        parts.append(f"{name} jumps by {size:.3g} {per} {where}")
    return "; ".join(parts)


def _record(result: Any) -> Any:
    """The fields of a result, as its `to_dict` gives them where it has one."""
    if hasattr(result, "to_dict"):
        return result.to_dict()
    if is_dataclass(result):
        return {each.name: getattr(result, each.name) for each in fields(result)}
    return result


def _poles(entity: Any) -> dict[str, Any]:
    """Numbers of poles and degrees of a curve, a surface, or the surface that is trimmed."""
    entity = getattr(entity, "surface", entity)
    degree = [entity.degree_u, entity.degree_v] if hasattr(entity, "degree_u") else [entity.degree]
    return {"poles": list(entity.control_points.shape[:-1]), "degree": degree, "rational": entity.weights is not None}


def _figure(value: Any, scale: float) -> str:
    return f"{value * scale:.6g}" if isinstance(value, float) else str(value)


def _metres(unit: str) -> float:
    """Metres in one unit of length."""
    from bladewright.section.checks import UNITS

    return UNITS[unit]
