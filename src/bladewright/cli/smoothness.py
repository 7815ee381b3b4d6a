"""Smoothness of what a design built, as nested figures and as lines to read."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from bladewright.blade.blade import Blade
    from bladewright.section.section import Section

SPANS = (0.0, 0.5, 1.0)
LINES = {"upper": "upper side", "lower": "lower side", "camber": "camber line"}
QUANTITIES = {"curvature": "curvature", "slope": "its slope"}


def smoothness_data(built: "Blade | Section") -> list[dict[str, Any]]:
    """Curvature and slope with their jumps, by line, of the sections at hub, mid-span and shroud, or of one section."""
    from bladewright.blade.shown_spans import shown_spans
    from bladewright.section.section import Section
    from bladewright.section.smoothness import smoothness

    if isinstance(built, Section):
        return [{"span": built.span, **smoothness(built).to_dict()}]
    return [{"span": v, **built.smoothness(v).to_dict()} for v in shown_spans(built.exact, SPANS)]


def smoothness_rows(found: list[dict[str, Any]]) -> list[tuple[str, str]]:
    """Names and values for people: what is continuous on every section, and the largest jump of what is not."""
    return [(name, _said(found, line)) for line, name in LINES.items() if found]


def _said(found: list[dict[str, Any]], line: str) -> str:
    parts = []
    for quantity, name in QUANTITIES.items():
        own = [each[line] for each in found]
        if all(each[f"{quantity}_continuous"] for each in own):
            parts.append(f"{name} continuous")
            continue
        worst = max(each[f"{quantity}_jump_of_largest"] for each in own)
        share = f"{100.0 * worst:.{2 if worst < 0.1 else 3}g} % of its largest"
        parts.append(f"{name} jumps by {share}" if worst else f"{name} with it")
    return ", ".join(parts)
