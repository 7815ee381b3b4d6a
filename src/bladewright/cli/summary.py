"""What a design builds, as nested figures, and as lines to read."""

from collections.abc import Sequence
from dataclasses import fields, is_dataclass
from typing import Any

from bladewright.cli.outcome import jsonable
from bladewright.designs import Design

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


def data_of(design: Design, built: Any) -> dict[str, Any]:
    """Names, size [m], error, properties [m], promises and poles of the blade or section that a design built."""
    from bladewright.files.families import family_of

    faces = getattr(built, "surfaces", None) or getattr(built, "curves", {})
    data = {
        "name": getattr(design, "name", ""),
        "family": family_of(design),
        "parameters": len(design.parameters()),
        "chord_m": getattr(built, "chord", None),
        "error": getattr(built, "error", None),
        "properties": _record(getattr(built, "properties", built)),
        "promises": _record(getattr(built, "promises", None)),
        "surfaces" if hasattr(built, "surfaces") else "curves": {name: _poles(face) for name, face in faces.items()},
    }
    return {key: jsonable(value) for key, value in data.items() if value is not None}


def text_of(data: dict[str, Any], more: Sequence[tuple[str, str]] = ()) -> str:
    """The same figures to read, lengths in millimetres: size and error, properties, poles, and promises with limits.

    `more` are names and values that stand before the poles.
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
    for name, face in data.get("surfaces", data.get("curves", {})).items():
        poles, degree = (" x ".join(map(str, face[key])) for key in ("poles", "degree"))
        rows.append((name, f"{poles} poles of degree {degree}{', rational' if face['rational'] else ''}"))
    promises = data.get("promises", {})
    for name, limit in promises.get("limits", {}).items():
        value = promises[name]
        said = f"{'unknown' if value is None else f'{value:.2g}'}, promised within {limit:.2g}"
        rows.append((name.replace("_", " "), said + ("" if _kept(value, limit) else ": NOT KEPT")))
    if promises.get("twist") is not None and "twist" not in promises["limits"]:
        cut = f"a flank cutter cuts {promises['flank_cut']:.2g} of its radius into it"
        rows.append(("twist", f"{promises['twist']:.3g} deg along the line at u = {promises['twist_at']:.3g}: {cut}"))
    width = max((len(name) for name, _ in rows), default=0)
    head = f"{data['name']}: {data['family']}, {data['parameters']} parameters"
    return "\n".join([head, *(f"  {name:<{width}}  {value}" for name, value in rows)])


def broken_promises(data: dict[str, Any]) -> tuple[str, ...]:
    """A line for every promise that misses its limit."""
    promises = data.get("promises", {})
    return tuple(
        f"{data['name']}: the promise '{name}' is not kept: {promises[name]} where {limit} is allowed"
        for name, limit in promises.get("limits", {}).items()
        if not _kept(promises[name], limit)
    )


def _kept(value: float | None, limit: float) -> bool:
    return value is not None and value <= limit


def _record(result: Any) -> Any:
    if hasattr(result, "to_dict"):
        return result.to_dict()
    if is_dataclass(result):
        return {each.name: getattr(result, each.name) for each in fields(result)}
    return result


def _poles(face: Any) -> dict[str, Any]:
    face = getattr(face, "surface", face)
    degree = [face.degree_u, face.degree_v] if hasattr(face, "degree_u") else [face.degree]
    return {"poles": list(face.control_points.shape[:-1]), "degree": degree, "rational": face.weights is not None}


def _figures(value: Any, scale: float) -> str:
    if isinstance(value, list):
        nested = any(isinstance(item, list) for item in value)
        return (", " if nested else " ").join(_figures(item, scale) for item in value)
    return f"{value * scale:.6g}" if isinstance(value, float) else str(value)
