"""Cuts and fillets of a given design: a match is of the blade before them, and the design that is found has them again.

Where a ball of radius r rolls along a wall and a side that meet at the angle a, it touches the side r (1 + cos a) above
the wall: no higher than 2 r. Edges and ends that are cut off, and walls that fillets hide, are held as they are given.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bladewright.blade.design.row_design import RowDesign
from bladewright.designs import Design, unit_at
from bladewright.fitting.assessment.measurement import off_walls
from bladewright.fitting.free_parameters import EDGES, WALLS, FreeParameters
from bladewright.fitting.matching.search import Task
from bladewright.nurbs.basis import Reals

ON_CUT = 1e-3
"""distance from a cut, of the cloud's extent, within which points may lie on its face: 0.1 mm of 100 mm, some standard
deviations of a scan's noise. Points of the sides there are not weighed, but measured."""
CUT_PLACES = {"hub": "hub", "tip": "shroud", **{edge: edge for edge in EDGES}}
"""the edge or wall in whose place a cut is"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Finishing:
    """The cuts and fillets of a blade's design."""

    design: RowDesign
    """that has them"""

    @property
    def names(self) -> tuple[str, ...]:
        """The fields that the design before them is without."""
        names = ("cut", "hub_fillet", "shroud_fillet", "hub_clearance", "tip_clearance")
        return tuple(n for n in names if getattr(self.design, n) is not None and getattr(self.design.plain, n) is None)

    @property
    def cut(self) -> frozenset[str]:
        """Edges and walls that are cut off."""
        return frozenset(
            place for name, place in CUT_PLACES.items() if getattr(self.design.cut, name, None) is not None
        )

    @property
    def heights(self) -> dict[str, float]:
        """The most that a fillet reaches above the wall [m], by the wall's name."""
        sizes = {
            wall: [v for path, v in self.design.parameters().items() if path.startswith(f"{wall}_fillet.")]
            for wall in WALLS
        }
        return {wall: 2.0 * self.design.metre * max(each) for wall, each in sizes.items() if each}

    def hides(self, points: Reals, start: Design) -> NDArray[np.str_]:
        """Which of points (n, 3) [m] may lie on a `face` of fillets and cuts, by a plain design nearby; else empty."""
        ends = dict(zip(WALLS, self.design.ends, strict=True))
        reach = {ends[wall]: height for wall, height in self.heights.items()}
        on_cut = ON_CUT * float(np.max(np.ptp(points, axis=0)))
        off = off_walls(points, self.given_to(start).build())
        hidden = np.any([far < reach.get(name, on_cut) for name, far in off.items()], axis=0)
        return np.where(hidden, "face", "")

    def shown(self, task: Task, free: FreeParameters, hidden: NDArray[np.str_]) -> Task:
        """The task without the points that are hidden, and with what these would show held."""
        return replace(
            task.part(np.flatnonzero(hidden == "")),
            free=replace(free, unseen=self.cut | {*self.heights}),
            cut_edges=self.cut & {*EDGES},
        )

    def given_to(self, design: Design) -> Design:
        """A design with the cuts and fillets, their lengths in its own unit."""
        found = design.changed({name: getattr(self.design, name) for name in self.names})
        scale = self.design.metre / found.metre  # type: ignore[attr-defined]
        lengths = {
            path: value * scale
            for path, value in self.design.parameters().items()
            if path.replace("[", ".").partition(".")[0] in self.names and unit_at(self.design, path) == "length"
        }
        return found if scale == 1.0 else found.changed(lengths)


def without_finishing(
    start: Design | None, like: Design | None, name: str
) -> tuple[Finishing | None, Design | None, Design | None]:
    """The cuts and fillets of a start, or of what the design is to be like, and both without them.

    Without a start the search begins with the one that it is to be like, for what is cut off or behind a fillet is in
    no cloud.
    """
    given = next((each for each in (start, like) if isinstance(each, RowDesign) and each.plain is not each), None)
    if given is None:
        return None, start, like
    first = given.changed("name", name) if start is None else start
    return Finishing(design=given), first.plain, None if like is None else like.plain
