"""The blade of the unified family whose sections those of another family begin as."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import chain

from bladewright.designs import Design
from bladewright.fitting.assessment.acceptance import NEAR_EVERYWHERE, MatchTarget
from bladewright.fitting.families.laws import LAW_COUNT
from bladewright.fitting.free_parameters import FreeParameters
from bladewright.fitting.initial_guess.blade import FirstBlade
from bladewright.fitting.matching.search import Match, Task, can_be_built, searched
from bladewright.fitting.model_selection.selection import GUESS_NOISE, QUICK_POINTS, SEVERAL_POINTS
from bladewright.fitting.model_selection.structure import structure_of
from bladewright.fitting.model_selection.structure_search import StructureSearch
from bladewright.section.unified_limits import RADII

QUICK_ROUNDS = 4
"""rounds of the search for the closed blade that the first design is taken from (design/matching_constants.md)"""
RICH_LAW_COUNT = 6
"""control points of each law along the span of a first blade whose closed one needed a rich structure
(design/matching.md)"""
SMALLER_RADII = (0.8, 0.4, 0.2)
"""shares of its edge radii with which a closed blade is tried that cannot be built with all (design/matching.md)"""


def closed_blades(task: Task, begun: FirstBlade) -> Iterator[tuple[Design, int]]:
    """Closed blades from a first one, in the order to be tried, and the control points of laws that begin with them.

    They are searched, with a rich structure where few control points are not near everywhere; the last is the one that
    the search began with, whose edges miss no wall. Sections and channel are all that is taken from them, so that they
    need not be fit to be built.
    """
    task = replace(task.turned(begun.turn), free=FreeParameters(), bounds={}, walls=task.walls or begun.walls)
    found = searched(task.thinned(QUICK_POINTS), begun.design, noise=GUESS_NOISE, rounds=QUICK_ROUNDS)
    if found.maximum > NEAR_EVERYWHERE * found.model.chord:
        yield _with_smaller_radii(_rich(task.thinned(SEVERAL_POINTS), found).design), RICH_LAW_COUNT
    yield _with_smaller_radii(found.design), LAW_COUNT
    yield begun.design, LAW_COUNT


def _with_smaller_radii(design: Design) -> Design:
    """A design with edge radii with which it can be built: between the places that hold them, laws may pass those."""
    radii = {path: value for path, value in design.parameters().items() if path.startswith(RADII)}
    smaller = (design.changed({path: share * radii[path] for path in radii}) for share in SMALLER_RADII)
    return next(filter(can_be_built, chain([design], smaller)), design)


def _rich(task: Task, match: Match) -> Match:
    """The match of a rich structure: few control points do not follow sections that change much along the span."""
    search = StructureSearch(task=task, samples=structure_of(match.design).samples, first=match.design)
    return search.rich(match, MatchTarget(structured=True))
