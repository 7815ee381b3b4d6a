"""Laws along the span of a family's part: from sections at several places, in a structure."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from bladewright.designs import Law, Part
from bladewright.nurbs.basis import Reals
from bladewright.section.laws import law_basis, named_laws


def plain(part: Any) -> Any:
    """The part with a number in place of each law: its mean."""
    return part.changed({path: float(np.mean(law)) for path, law in named_laws(part)})


def counts_of(part: Part) -> Mapping[str, int]:
    """The number of control points of each law of a part by its path."""
    return {path: len(law) if isinstance(law, tuple) else 1 for path, law in named_laws(part)}


def along_span(parts: Sequence[Any], v: Reals, counts: Mapping[str, int]) -> Any:
    """One part of laws from parts of numbers at places v (m,) along the span, by least squares of each number."""
    values = [_scaled(part).parameters() for part in parts]
    middle = parts[len(parts) // 2]
    return middle.changed({path: nearest_law([each[path] for each in values], v, counts[path]) for path in values[0]})


def nearest_law(values: Sequence[float], v: Reals, count: int) -> Law:
    """The law of so many control points nearest to values (m,) at places v (m,), inside their range."""
    at = np.asarray(values)
    if count == 1:
        return float(np.median(at))
    found = np.linalg.lstsq(law_basis(count, v), at, rcond=None)[0]
    room = 0.5 * float(np.ptp(at))
    low, high = float(np.min(at)), float(np.max(at))
    # a law that runs past its values by much may leave the range in which there is a shape
    low, high = (low - room, high + room) if low < 0.0 else (max(low - room, 0.5 * low), high + room)
    return tuple(np.clip(found, low, high).tolist())


def _scaled(part: Any) -> Any:
    """The part with control points of a second derivative whose sum of magnitudes is one: they count by ratios."""
    values = {path: value for path, value in part.parameters().items() if path.startswith("curvature[")}
    total = float(np.sum(np.abs(list(values.values()))))
    return part.changed({path: value / total for path, value in values.items()}) if total > 0.0 else part
