"""The laws of a family's part: as lines of control points, and along the span from sections at several places."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields
from typing import Any

import numpy as np

from bladewright.designs import Law, Part
from bladewright.nurbs.basis import Reals
from bladewright.section.laws import is_list, law_basis, law_points, named_laws, number_paths, sampled_at, stations_of


def lines_of(part: Part, stem: str) -> Iterator[list[str]]:
    """Paths of control points in a row, for every law of a part and every row of laws."""
    for each in fields(part):
        value, path = getattr(part, each.name), f"{stem}.{each.name}"
        if isinstance(value, Part) and "unit" not in each.metadata:
            yield from lines_of(value, path)
        elif "unit" in each.metadata and is_list(value):
            yield from _lines(value, path)


def _lines(value: Any, path: str) -> Iterator[list[str]]:
    if not (isinstance(value, tuple) and any(map(is_list, value))):
        yield number_paths(value, path)
        return
    rows = [number_paths(item, f"{path}[{i}]") for i, item in enumerate(value)]
    yield from rows
    if len({len(row) for row in rows}) == 1:
        yield from (list(column) for column in zip(*rows, strict=True))


def with_mean_laws(part: Any) -> Any:
    """The part with each law replaced by its mean, a number."""
    return part.changed({path: float(np.mean(law_points(law))) for path, law in named_laws(part)})


def counts_of(part: Part) -> Mapping[str, int]:
    """The number of control points of each law of a part by its path."""
    return {path: len(law_points(law)) for path, law in named_laws(part)}


def with_stations_of(part: Any, like: Part) -> Any:
    """The part with those laws given at stations that are so in `like`: the values of its own laws there."""
    stations = {path: found for path, law in named_laws(like) if (found := stations_of(law))}
    own = {path: law for path, law in named_laws(part) if path in stations}
    return part.changed({path: sampled_at(law, stations[path]) for path, law in own.items()})


def part_along_span(parts: Sequence[Any], v: Reals, counts: Mapping[str, int]) -> Any:
    """One part of laws from parts of numbers at places v (m,) along the span, by least squares of each number."""
    values = [_with_unit_curvature(part).parameters() for part in parts]
    middle = parts[len(parts) // 2]
    return middle.changed({path: nearest_law([each[path] for each in values], v, counts[path]) for path in values[0]})


def nearest_law(values: Sequence[float], v: Reals, count: int) -> Law:
    """The law of so many control points nearest to values (m,) at places v (m,), kept inside their range."""
    at = np.asarray(values)
    if count == 1:
        return float(np.median(at))
    found = np.linalg.lstsq(law_basis(count, v), at, rcond=None)[0]
    margin = 0.5 * float(np.ptp(at))
    low, high = float(np.min(at)), float(np.max(at))
    # a law that runs past its values by much may leave the range in which there is a shape
    low, high = (low - margin, high + margin) if low < 0.0 else (max(low - margin, 0.5 * low), high + margin)
    return tuple(np.clip(found, low, high).tolist())


def _with_unit_curvature(part: Any) -> Any:
    """The part with control points of a second derivative scaled to a sum of magnitudes of one: ratios count."""
    values = {path: value for path, value in part.parameters().items() if path.startswith("curvature[")}
    total = float(np.sum(np.abs(list(values.values()))))
    return part.changed({path: value / total for path, value in values.items()}) if total > 0.0 else part
