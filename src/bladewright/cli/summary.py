"""What a design builds, as nested figures for JSON and as lines to read."""

from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bladewright.cli.load_design import naming_file, passage_from
from bladewright.cli.outcome import jsonable
from bladewright.designs import Design
from bladewright.errors import DesignError

if TYPE_CHECKING:
    from bladewright.blade.native.blade import Blade
    from bladewright.section.section import Section


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


def summary_data(design: Design, built: Any) -> dict[str, Any]:
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


def summary_text(data: dict[str, Any], more: Sequence[tuple[str, str]] = ()) -> str:
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


SMOOTHNESS_SPANS = (0.0, 0.5, 1.0)
LINE_NAMES = {"upper": "upper side", "lower": "lower side", "camber": "camber line"}
QUANTITY_NAMES = {"curvature": "curvature", "slope": "its slope"}


def smoothness_data(built: "Blade | Section") -> list[dict[str, Any]]:
    """Curvature and slope with their jumps, by line, of the sections at hub, mid-span and shroud, or of one section."""
    from bladewright.blade.exact.exact_blade import shown_spans
    from bladewright.section.section import Section
    from bladewright.section.smoothness import smoothness

    if isinstance(built, Section):
        return [{"span": built.span, **smoothness(built).to_dict()}]
    return [{"span": v, **built.smoothness(v).to_dict()} for v in shown_spans(built.exact, SMOOTHNESS_SPANS)]


def smoothness_rows(found: list[dict[str, Any]]) -> list[tuple[str, str]]:
    """Names and values for people: what is continuous on every section, and the largest jump of what is not."""
    return [(name, _smoothness_text(found, line)) for line, name in LINE_NAMES.items() if found]


def _smoothness_text(found: list[dict[str, Any]], line: str) -> str:
    parts = []
    for quantity, name in QUANTITY_NAMES.items():
        own = [each[line] for each in found]
        if all(each[f"{quantity}_continuous"] for each in own):
            parts.append(f"{name} continuous")
            continue
        worst = max(each[f"{quantity}_jump_of_largest"] for each in own)
        share = f"{100.0 * worst:.{2 if worst < 0.1 else 3}g} % of its largest"
        parts.append(f"{name} jumps by {share}" if worst else f"{name} with it")
    return ", ".join(parts)


PASSAGE_LIMITS = {"ring_filled": 1e-6, "walls": 1e-7}
"""of the ring's volume by which passages and blades miss it, and of the chord by which walls miss theirs"""


def flow_domain(design: Any, path: Path, reach: Mapping[str, Any]) -> Any:
    """The passage of a design, 2D where the design is.

    Raises DesignError, naming the file at `path`, where the shape is impossible.
    """
    from bladewright.section.unified import UnifiedSection

    if not isinstance(design, UnifiedSection):
        return passage_from(design, path, **reach)
    from bladewright.domain.section import section_passage
    from bladewright.section.checks import UNITS

    if reach.get("split"):
        raise click.UsageError("--split cuts the faces of a passage: the curves around a 2D section have no creases")
    if design.pitch is None:
        raise DesignError(f"{path}: pitch is missing: a passage lies between neighbours; set pitch in the design")
    asked = {name: value for name, value in reach.items() if name != "split" and value is not None}
    with naming_file(path):
        return section_passage(design.build(), design.pitch * UNITS[design.length_unit], **asked)


def passage_data(design: Any, made: Any) -> dict[str, Any]:
    """Figures as `data_of` gives them, and those of a passage alone: ring, extents, folds and what they are held to."""
    import numpy as np

    if hasattr(made, "section"):
        area = {"area": made.area, "pitch": np.ptp(np.real(made.curves["inlet"].control_points[:, 1]))}
        return {**summary_data(design, made), "name": f"{design.name}-passage", "properties": jsonable(area)}
    reached = {"ring_filled": abs(made.ring_error), "walls": made.wall_error}
    folds = {name: dict(zip(("share", "u", "v"), fold, strict=True)) for name, fold in made.folds.items()}
    own = {
        "name": made.name,
        "ring_m3": np.real(made.ring),
        "upstream": made.knots.upstream,
        "downstream": made.knots.downstream,
        "meridional_length_m": made.knots.length,
        "least_jacobian": folds,
        "promises": {
            **reached,
            "limits": PASSAGE_LIMITS,
            "kept": all(reached[each] <= PASSAGE_LIMITS[each] for each in PASSAGE_LIMITS),
        },
    }
    return {**summary_data(design, made), **{key: jsonable(value) for key, value in own.items()}}


def passage_rows(data: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Names and values of what a passage alone has, to read."""
    if "ring_m3" not in data:
        return []
    length = data["meridional_length_m"] * 1e3
    rows = [("ring", f"{data['ring_m3'] * 1e9:.6g} mm3")]
    rows += [(name, f"{data[name]:.4g} meridional lengths of {length:.6g} mm") for name in ("upstream", "downstream")]
    name, fold = min(data["least_jacobian"].items(), key=lambda each: each[1]["share"])
    said = f"{fold['share']:.2g} of its median, on {name} at u = {fold['u']:.4g}, v = {fold['v']:.4g}"
    return [*rows, ("least Jacobian", said)]
