"""What is held of a design where its cloud says nothing: smooth laws, equal sides, nothing far from the start.

The rows are linear in the scaled parameters and have variance one. A search weighs them with the noise of the cloud, so
that they vanish beside data that are exact.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Any

import numpy as np

from bladewright.designs import Design, Part
from bladewright.fitting.families.laws import lines_of
from bladewright.fitting.free_parameters import EDGES
from bladewright.fitting.model_selection.structure import SPANWISE
from bladewright.nurbs.basis import Reals
from bladewright.section.laws import number_paths
from bladewright.section.unified_limits import THICKNESSES

SPREAD_ABOUT_START = 3.0
"""spread of a parameter about its start, in its own scale. It only holds what nothing else does."""
CHANNEL_SPREAD = 1.0
"""the same of control points of the meridional curves, which the cloud lets slide along their curves."""
CORNER_SPREAD = 0.25
"""the same of the channel's corners: where no row of points shows an end of the blade, the outline does, within half a
percent of the chord. With 0.5 a corner of the radial turbine ends 9 % of the chord outside its points."""
MERIDIANS = ("channel.", "flow_path.", "leading_edge.", "trailing_edge.")
"""beginnings of the paths of those, and of the edge curves and walls of blades from sections."""
BEND_SPREAD = 0.5
"""spread of the second differences of a law, in the scale of its parameters. Smaller values straighten laws that the
cloud bends."""
CAMBER_SPREAD = 0.3
"""spread of the difference of upper and lower thickness, in their scale: a camber line in the middle is preferred."""

Terms = list[tuple[str, float]]
"""paths of parameters and their factors in a row"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Regularisation:
    """Rows `matrix @ z - rhs`, with z the scaled change of the parameters."""

    matrix: Reals
    """(m, k) rows by scaled parameters"""
    rhs: Reals
    """(m,) what the rows should be"""

    def scaled(self, factor: float) -> "Regularisation":
        """The same with all rows multiplied by a factor."""
        return Regularisation(matrix=self.matrix * factor, rhs=self.rhs * factor)

    def residuals(self, z: Reals) -> Reals:
        """The residuals (m,) of scaled changes (k,)."""
        return self.matrix @ z - self.rhs


def regularisation_of(start: Design, paths: Sequence[str], size: Reals, *, ends_shown: bool = True) -> Regularisation:
    """The regularisation about a start, for parameters (k,) of scale `size`.

    `ends_shown` tells whether rows of points show both ends of the blade.
    """
    spread = np.where([path.startswith(MERIDIANS) for path in paths], CHANNEL_SPREAD, SPREAD_ABOUT_START)
    corners = set[str]() if ends_shown else _corners(start)
    spread = np.where([path.rpartition(".")[0] in corners for path in paths], CORNER_SPREAD, spread)
    rows, rhs_rows = [np.diag(1.0 / spread)], [np.zeros(len(paths))]
    values = start.parameters()
    index = {path: i for i, path in enumerate(paths)}
    for terms, width in chain(_second_differences(start), _thickness_differences(start)):
        free = [index[path] for path, _ in terms if path in index]
        if not free:
            continue
        scale = float(np.max(size[free]))
        row = np.zeros((1, len(paths)))
        for path, factor in terms:
            if path in index:
                row[0, index[path]] += factor * size[index[path]] / (width * scale)
        rows.append(row)
        rhs_rows.append(np.array([-sum(factor * values[path] for path, factor in terms) / (width * scale)]))
    return Regularisation(matrix=np.concatenate(rows), rhs=np.concatenate(rhs_rows))


def _corners(start: Design) -> set[str]:
    """Paths of the points in which edges and walls of a channel meet."""
    channel = getattr(start, "channel", None)
    if channel is None:
        return set()
    return {f"channel.{edge}[{at}]" for edge in EDGES for at in (0, len(getattr(channel, edge)) - 1)}


def _second_differences(start: Design) -> Iterator[tuple[Terms, float]]:
    """Second differences of laws along the span and along the chord."""
    for name in (*SPANWISE, *THICKNESSES, "leading_edge_theta", "leading_edge_y"):
        grid = paths_of(name, getattr(start, name, None))
        counts = {len(line) for line in grid}
        lines = [*grid, *(zip(*grid, strict=True) if len(counts) == 1 else ())]
        for line in lines:
            yield from _second_differences_of(line)
    if isinstance(getattr(start, "section", None), Part):
        for line in lines_of(start.section, "section"):  # type: ignore[attr-defined]
            yield from _second_differences_of(line)


def _second_differences_of(line: Sequence[str]) -> Iterator[tuple[Terms, float]]:
    for before, at, after in zip(line, line[1:], line[2:], strict=False):
        yield [(before, 1.0), (at, -2.0), (after, 1.0)], BEND_SPREAD


def _thickness_differences(start: Design) -> Iterator[tuple[Terms, float]]:
    above, below = (paths_of(name, getattr(start, name, None)) for name in THICKNESSES)
    if [len(row) for row in above] == [len(row) for row in below]:
        for pair in zip(chain(*above), chain(*below), strict=True):
            yield list(zip(pair, (1.0, -1.0), strict=True)), CAMBER_SPREAD


def paths_of(name: str, law: Any) -> list[list[str]]:
    """Paths of a law's control points along the span, a list for each control point along the chord."""
    if law is None:
        return []
    chordwise = name in THICKNESSES
    rows = []
    for i, entry in enumerate(law if chordwise else (law,)):
        stem = f"{name}[{i}]" if chordwise else name
        rows.append(number_paths(entry, stem))
    return rows
