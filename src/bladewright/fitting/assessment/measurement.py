"""The final measurement of a match: every point of the cloud against what the design builds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bladewright.blade.native.blade import Blade
from bladewright.blade.native.cut_lines import in_meridian
from bladewright.fitting.free_parameters import EDGES
from bladewright.fitting.matching.blade_ends import END_PARAMETERS, WallPoints, blade_ends_of
from bladewright.fitting.matching.footpoints import EDGE_PARAMETERS, Footpoints, nearest_footpoints
from bladewright.fitting.matching.noise import EDGE_BAND, noise_of
from bladewright.fitting.models.model import ModelShape, blunt_edges_of, on_sides, sides_of
from bladewright.numerics.robust import median_deviation
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.closest import Descents
from bladewright.nurbs.surface import Surface
from bladewright.section.section import Section

LAST_STEP = 1e-10
"""last step of the descents, in the parameters of a patch: points on a blade of 36 mm chord are then 1e-11 m off, and
2e-10 m with the 1e-8 of other searches"""
OFF_SIDES = 3.0
"""standard deviations of the distances from which a point is off the sides, and may be on another face: the three sigma
rule (Pukelsheim 1994)"""


@dataclass(frozen=True, kw_only=True, eq=False)
class PlacesOfPoints:
    """Where the n points of a cloud lie on what was built."""

    places: NDArray[np.str_]
    """(n,) name of the nearest curve or surface: `upper`, `lower`, or one of the blade's ends or faces"""
    u: Reals
    """(n,) parameter of the nearest place along the chord"""
    v: Reals
    """(n,) parameter of the nearest place along the span; 0 for a section"""
    deviations: Reals
    """(n,) distance from the nearest place, positive outside the blade [m]"""
    regions: NDArray[np.str_]
    """(n,) region of each point: `sides`, `leading edge`, `trailing edge` or `ends`"""
    inliers: NDArray[np.bool_]
    """(n,) whether a point took part; the others are outliers, or set aside"""
    set_aside: NDArray[np.str_]
    """(n,) what a point lies on that is none of the sides, such as `hub fillet`; empty where it took part"""
    noise: float
    """standard deviation of the cloud's own noise, as neighbouring points show it [m]"""

    @property
    def distances(self) -> Reals:
        """(n,) true distances from the surface [m]."""
        return np.sqrt(self.deviations**2)


@dataclass(frozen=True, kw_only=True, eq=False)
class Measurement(PlacesOfPoints):
    """Where the n points of a cloud lie on what was built, with the footpoints before cuts and fillets."""

    footpoints: Footpoints

    @property
    def outliers(self) -> NDArray[np.bool_]:
        """(n,) whether a point is an outlier."""
        return np.asarray(~self.inliers & (self.set_aside == ""))


def measured(
    points: Reals,
    built: Blade | Section,
    precision: Reals | None = None,
    *,
    hidden: NDArray[np.str_] | None = None,
    finished: Blade | None = None,
    hint: Footpoints | None = None,
) -> Measurement:
    """Every point's nearest place and signed distance on a blade or section, before cuts and fillets.

    `precision` (n,) are inverse variances of the points, relative to each other. Where `hidden` (n,) is not
    empty, points off the sides are set aside: on a `wall` or a `fillet` beside the blade, or on the faces of cuts and
    fillets that the `finished` blade has, where they are nearer to these. So are points of the end faces, which are
    outliers to the sides. A `hint` are the footpoints on a blade that is hardly another one.
    """
    sides = sides_of(built)
    exact = built.exact if isinstance(built, Blade) else None
    footpoints = nearest_footpoints(points, sides, hint, converged=LAST_STEP)
    # the longest name is "cut trailing edge"
    set_aside, off = np.full(len(points), "", dtype="<U20"), footpoints.distances
    if hidden is not None and finished is not None and np.any(hidden != ""):
        rows = np.flatnonzero(hidden != "")
        rows = rows[off[rows] > OFF_SIDES * median_deviation(off[hidden == ""])]
        names, far = off_finished_faces(points[rows], finished)
        if finished is built:
            # it has no fillets of its own
            set_aside[rows] = np.where(hidden[rows] == "fillet", np.char.add(names, " fillet"), names)
        else:
            set_aside[rows] = np.where(far < off[rows], names, "")
        off[rows] = np.minimum(far, off[rows])
    rows = np.flatnonzero(set_aside == "")
    noise_estimate = noise_of(points[rows], footpoints.part(rows), None if precision is None else precision[rows])
    inliers = np.zeros(len(points), dtype=bool)
    inliers[rows] = noise_estimate.inliers
    shape = ModelShape(design=None, sides=sides, exact=exact)
    on_end_face = blade_ends_of(points, footpoints, shape, set_aside == "").on_end_face
    deviations = np.where(footpoints.heights < 0.0, -1.0, 1.0) * off
    near_edges = [footpoints.u < EDGE_BAND, footpoints.u > 1.0 - EDGE_BAND]
    footpoints, on_face = on_sides(footpoints, blunt_edges_of(built))
    on_side = np.where(footpoints.side == 0, "upper", "lower")
    places = np.select([set_aside != "", on_face < 0, on_face > 0], [set_aside, *EDGES], on_side)
    past_end = np.abs(np.sum(footpoints.miss * footpoints.beyond, axis=1)) > np.abs(footpoints.heights)
    regions = np.select([past_end, *near_edges], ["ends", *EDGE_PARAMETERS], "sides")
    if isinstance(built, Blade):
        for (name, end), face in zip(END_PARAMETERS.items(), built.design.ends, strict=True):
            rows = np.flatnonzero(on_end_face & (np.abs(footpoints.v - end) < 0.5))
            set_aside[rows[~inliers[rows] & (set_aside[rows] == "")]] = face
            outward = _off_wall(name, points[rows], built) * (1.0 if end else -1.0)
            nearer = np.abs(outward) < np.abs(deviations[rows])
            deviations[rows[nearer]] = outward[nearer]
            places[rows[nearer]], regions[rows[nearer]] = face, "ends"
    return Measurement(
        places=places,
        u=footpoints.u,
        v=footpoints.v,
        footpoints=footpoints,
        deviations=deviations,
        regions=regions,
        inliers=inliers,
        noise=noise_estimate.noise,
        set_aside=set_aside,
    )


def _off_wall(name: str, points: Reals, built: Blade) -> Reals:
    """Signed distances (n,) [m] of points (n, 3) from hub or shroud."""
    places = in_meridian(points, built.exact.mapping.revolved)
    return WallPoints(name=name, places=places).located(built.exact)[2]


def off_walls(points: Reals, built: Blade) -> dict[str, Reals]:
    """Distances (n,) [m] of points (n, 3) from the walls and faces of revolution that cuts and fillets have changed."""
    places = in_meridian(points, built.exact.mapping.revolved)
    return {name: np.sqrt(Descents((curve,)).nearest(places).square) for name, (curve, _) in built.walls.items()}


def off_finished_faces(points: Reals, built: Blade) -> tuple[NDArray[np.str_], Reals]:
    """The nearest of these faces for each of points (n, 3), such as `cut trailing edge`, and how far it is [m]."""
    off = {f"cut {name}" if name.endswith("_edge") else name: far for name, far in off_walls(points, built).items()}
    for wall, name in zip(END_PARAMETERS, built.design.ends, strict=True):
        if name not in off:
            off[name] = np.abs(_off_wall(wall, points, built))
    for name, face in built.surfaces.items():
        if "_fillet" in name and isinstance(face, Surface):
            own = f"{name.partition('_')[0]} fillet"
            far = np.sqrt(Descents((face,)).nearest(points).square)
            off[own] = np.minimum(off.get(own, np.inf), far)
    names, every = np.array([name.replace("_", " ") for name in off]), np.stack(list(off.values()))
    nearest = np.argmin(every, axis=0)
    return names[nearest], every[nearest, np.arange(len(points))]
