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
the distance of its walls from hub and shroud, in chords, which is what a blade promises of its own ends."""
SMOOTHNESS_SPANS = (0.0, 0.5, 1.0)
"""Span fractions at which smoothness is reported."""
LINE_NAMES = {"upper": "upper side", "lower": "lower side", "camber": "camber line"}
"""What the lines of a section are called in the table."""
QUANTITY_NAMES = {"curvature": "curvature", "slope": "its slope"}
"""What is compared at the joints of a line, and its words in the table."""
_MILLIMETRES = {
    "volume": ("mm3", 1e9),
    "area": ("mm2", 1e6),
    "areas": ("mm2", 1e6),
    "centroid": ("mm", 1e3),
    "inertia": ("mm5", 1e15),
    "camber_length": ("mm", 1e3),
    "perimeter": ("mm", 1e3),
    "pitch": ("mm", 1e3),
    "maximum_thickness": ("mm", 1e3),
    "maximum_camber": ("mm", 1e3),
    "edge_radii": ("mm", 1e3),
}
"""Unit in which a property is printed, and its factor from metres."""


def summary_data(design: Any, built: Any) -> dict[str, Any]:
    """Name, size [m], error, properties [m], promises and poles of the blade, section or passage of a design."""
    from bladewright.files.families import family_of

    entities = "surfaces" if built.dimension == 3 else "curves"
    data = {
        "name": design.name,
        "family": family_of(design),
        "parameters": len(design.parameters()),
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
        "least_jacobian": jacobians,
        "promises": {**errors, "limits": PASSAGE_LIMITS, "kept": kept},
    }
    return {**summary_data(design, built), **{key: jsonable(value) for key, value in own.items()}}


def smoothness_data(built: Any) -> list[dict[str, Any]]:
    """Curvature and its slope with their jumps, by line, of the sections at SMOOTHNESS_SPANS, or of one section."""
    from bladewright.section.smoothness import smoothness

    if built.dimension == 2:
        return [{"span": built.span, **smoothness(built).to_dict()}]
    return [{"span": v, **built.smoothness(v).to_dict()} for v in built.exact.shown_spans(SMOOTHNESS_SPANS)]


def summary_text(data: dict[str, Any], more: Sequence[tuple[str, str]] = ()) -> str:
    """The same figures to read, lengths in millimetres: size and error, properties, poles, and promises with limits.

    `more` are names and values that go before the poles.
    """
    rows = [("chord", f"{data['chord_m'] * 1e3:.6g} mm")] if "chord_m" in data else []
    if "error" in data:
        rows.append(("error", f"{data['error']:.2g} of the chord"))
    for name, value in data["properties"].items():
        if name == "chord":
            continue
        unit, scale = _MILLIMETRES.get(name, ("", 1.0))
        rows.append((name.replace("_", " "), f"{_figures(value, scale)} {unit}".rstrip()))
    rows += more
    for name, entity in data.get("surfaces", data.get("curves", {})).items():
        poles, degree = (" x ".join(map(str, entity[key])) for key in ("poles", "degree"))
        rows.append((name, f"{poles} poles of degree {degree}{', rational' if entity['rational'] else ''}"))
    rows += [*law_rows(data.get("laws", {})), *_promise_rows(data.get("promises", {}))]
    width = max((len(name) for name, _ in rows), default=0)
    head = f"{data['name']}: {data['family']}, {data['parameters']} parameters"
    return "\n".join([head, *(f"  {name:<{width}}  {value}" for name, value in rows)])


def passage_rows(data: Mapping[str, Any]) -> Rows:
    """Ring, extents and least Jacobian of a passage, to read; nothing for another body."""
    if "ring_m3" not in data:
        return []
    length = data["meridional_length_m"] * 1e3
    rows = [("ring", f"{data['ring_m3'] * 1e9:.6g} mm3")]
    rows += [(name, f"{data[name]:.4g} meridional lengths of {length:.6g} mm") for name in ("upstream", "downstream")]
    name, least = min(data["least_jacobian"].items(), key=lambda each: each[1]["share"])
    text = f"{least['share']:.2g} of its median, on {name} at u = {least['u']:.4g}, v = {least['v']:.4g}"
    return [*rows, ("least Jacobian", text)]


def smoothness_rows(sections: list[dict[str, Any]]) -> Rows:
    """What is continuous on every section, and the largest jump of what is not, to read."""
    return [(name, _smoothness_text(sections, line)) for line, name in LINE_NAMES.items() if sections]


def broken_promises(data: dict[str, Any]) -> tuple[str, ...]:
    """A line for every promise that misses its limit."""
    promises = data.get("promises", {})
    return tuple(
        f"{data['name']}: the promise '{name}' is not kept: {promises[name]} where {limit} is allowed"
        for name, limit in promises.get("limits", {}).items()
        if not _kept(promises[name], limit)
    )


def _promise_rows(promises: Mapping[str, Any]) -> Rows:
    rows = []
    for name, limit in promises.get("limits", {}).items():
        value = promises[name]
        text = f"{'unknown' if value is None else f'{value:.2g}'}, promised within {limit:.2g}"
        rows.append((name.replace("_", " "), text + ("" if _kept(value, limit) else ": NOT KEPT")))
    if promises.get("twist") is not None and "twist" not in promises["limits"]:
        cut = f"a flank cutter cuts {promises['flank_cut']:.2g} of its radius into it"
        rows.append(("twist", f"{promises['twist']:.3g} deg along the line at u = {promises['twist_at']:.3g}: {cut}"))
    return rows


def _kept(value: float | None, limit: float) -> bool:
    return value is not None and value <= limit


def _smoothness_text(sections: list[dict[str, Any]], line: str) -> str:
    parts = []
    for quantity, name in QUANTITY_NAMES.items():
        own = [section[line] for section in sections]
        if all(each[f"{quantity}_continuous"] for each in own):
            parts.append(f"{name} continuous")
            continue
        worst = max(each[f"{quantity}_jump_of_largest"] for each in own)
        share = f"{100.0 * worst:.{2 if worst < 0.1 else 3}g} % of its largest"
        parts.append(f"{name} jumps by {share}" if worst else f"{name} with it")
    return ", ".join(parts)


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


def _figures(value: Any, scale: float) -> str:
    if isinstance(value, list):
        nested = any(isinstance(item, list) for item in value)
        return (", " if nested else " ").join(_figures(item, scale) for item in value)
    return f"{value * scale:.6g}" if isinstance(value, float) else str(value)
