"""What a design builds, as nested figures, and as lines to read."""

from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from typing import Any

from bladewright.cli.outcome import jsonable
from bladewright.designs import Design


def data_of(design: Design, built: Any) -> dict[str, Any]:
    """Names, size, error, properties, promises and poles of what a design built."""
    from bladewright.files.families import family_of

    faces = getattr(built, "surfaces", None) or getattr(built, "curves", {})
    data = {
        "name": built.name,
        "family": family_of(design),
        "parameters": len(design.parameters()),
        "chord_m": getattr(built, "chord", None),
        "error": getattr(built, "error", None),
        "properties": _record(getattr(built, "properties", None)),
        "promises": _record(getattr(built, "promises", None)),
        "surfaces" if hasattr(built, "surfaces") else "curves": {name: _poles(face) for name, face in faces.items()},
    }
    return {key: jsonable(value) for key, value in data.items() if value is not None}


def text_of(data: dict[str, Any]) -> str:
    """The same figures, one a line."""
    lines = list(_lines(data, ""))
    width = max(len(name) for name, _ in lines)
    return "\n".join(f"{name:<{width}}  {value}" for name, value in lines)


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


def _lines(value: Any, name: str) -> Iterator[tuple[str, str]]:
    if isinstance(value, dict):
        for key, item in value.items():
            yield from _lines(item, f"{name}.{key}" if name else key)
    elif isinstance(value, float):
        yield name, f"{value:.6g}"
    elif isinstance(value, list):
        yield name, " ".join(f"{item:.6g}" if isinstance(item, float) else str(item) for item in value)
    else:
        yield name, str(value)
