"""The points of a case's sections in space, by T-Blade3's formulas or from the file that it has written of them."""

from pathlib import Path

import numpy as np

from bladewright.files.tblade3.records import TBlade3Case
from bladewright.files.tblade3.stacking import SIDE
from bladewright.files.tblade3.translation import CaseSections
from bladewright.nurbs.basis import Reals
from bladewright.section.laws import Span


def section_points(sections: CaseSections, index: int, places: Reals) -> tuple[Reals, Reals]:
    """Points (k, 3) [m] of a section's upper and lower side at the outline's s (k,).

    They are laid on the case's own stream line at its own m' and theta; neither laws nor stream surfaces have a part.
    """
    outline = sections.numbers.of(index).outline(Span(np.zeros(1)))
    upper, lower = (placed(sections, index, np.real(side)[0]) for side in outline.points(places))
    return upper, lower


def placed(sections: CaseSections, index: int, chords: Reals) -> Reals:
    """Points (k, 3) [m] in space of points (k, 2) of a section in chords."""
    turn, chord = sections.stagger[index], sections.chords[index]
    along = chord * (chords[:, 0] * np.cos(turn) - chords[:, 1] * np.sin(turn))
    across = chord * (chords[:, 0] * np.sin(turn) + chords[:, 1] * np.cos(turn))
    line, total = sections.flow.lines[index], sections.flow.totals[index]
    x, r = np.real(line.values((sections.leading[index] + along) / total)).T
    theta = sections.theta[index] + across
    return np.stack([x, r * np.sin(theta), r * np.cos(theta)], axis=-1)


def written_points(case: TBlade3Case) -> Reals | None:
    """Points (m, n, 3) [m] of the sections as T-Blade3 wrote them beside the case's file, or None where it did not.

    Each section runs from the trailing edge along the upper side, and back along the lower.
    """
    path = Path(case.file).with_name(f"blade3d.{case.name}.dat")
    try:
        rows = [line.split() for line in path.read_text().splitlines() if line.strip()]
        count, sections = (int(word) for word in rows[0][:2])
        found = np.array(rows[1:], dtype=np.float64).reshape(sections, count, 3)
    except (OSError, ValueError, IndexError):
        return None
    if len(found) != len(case.sections) or count != 2 * SIDE - 1 or not np.all(np.isfinite(found)):
        return None
    return found * case.unit_length / case.scale
