"""Parameters of a family's design that a cloud does not tell, and that stand where they are unless they are freed."""

import re

from bladewright.designs import Design


def standing(design: Design) -> frozenset[str]:
    """Paths of what is held: of control points that count by their ratios alone, the largest."""
    section = getattr(design, "section", None)
    if section is None:
        return frozenset()
    values = section.parameters()
    return frozenset(f"section.{path}" for path in _largest(values))


def _largest(values: dict[str, float]) -> list[str]:
    """The whole law of the control point of the second derivative that is largest."""
    found = {path: value for path, value in values.items() if re.match(r"curvature\[", path)}
    if not found:
        return []
    of = max(found, key=lambda path: found[path] ** 2)
    stem = re.match(r"curvature\[\d+\]", of)
    return [path for path in found if stem is not None and path.startswith(stem[0])]
