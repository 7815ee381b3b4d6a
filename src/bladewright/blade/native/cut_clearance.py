"""The clearance surface of an end that is cut: the cut's meridian, moved along its normals into the blade.

    C(t) = M(t) + d(u(t)) n(t),

u linear in t, 0 where the uncut blade's leading edge meets the cut and 1 where its trailing edge does, d linear in u.
"""

from collections.abc import Mapping

import numpy as np

from bladewright.blade.exact.clearance import Clearance
from bladewright.blade.native.blade import Blade
from bladewright.blade.native.cut_checks import about, met
from bladewright.blade.native.cut_lines import Found, Lines
from bladewright.blade.native.knots import DEGREE, refined
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, cross2, length
from bladewright.nurbs.basis import Reals, greville, knots_with_joints
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.fit import interpolated

REACHED = 1e-10
"""Distance of the fitted meridian from the exact one, of the chord, to which knots are refined."""
MOST_POLES = 400
"""Control points of the meridian up to which knots are added."""
BESIDE = 0.25
"""How far the meridian reaches past the blade, as a share of its stretch."""


def cleared_meridian(
    blade: Blade, end: str, cut: Curve, clearance: Clearance, near: Mapping[str, Found], knots: Reals | None
) -> Curve:
    """The meridian of the clearance surface beside a cut, at held knots if any; DesignError where it folds.

    `near` is about where lines of the faces meet the cut.
    """
    edges = np.array([0.0, 1.0])
    lines = Lines(face=blade.sides[0], along="v", at=edges, revolved=blade.plain.exact.mapping.revolved)
    found = met(lines, cut, about(edges, near["upper"]), f"cut.{end}")
    chord = float(np.real(blade.chord))

    def points(t: Reals) -> Array:
        slope = cut.derivative(t)
        normal = clearance.inward * np.stack([-slope[..., 1], slope[..., 0]], axis=-1) / length(slope)[..., None]
        u = (t - found.t[0]) / (found.t[1] - found.t[0])
        return cut(t) + clearance.distance(u)[..., None] * normal

    def fitted(on: Reals) -> Curve:
        sites = greville(on, DEGREE)
        return interpolated(points(sites), sites, degree=DEGREE, knots=on)

    if knots is None:
        low, high = (float(each) for each in np.sort(np.real(found.t)))
        reached = [float(pick(np.real(each.t))) for _, each in near.values() for pick in (np.min, np.max)]
        margin = BESIDE * (high - low)
        start, end_t = max(cut.domain[0], min(reached) - margin), min(cut.domain[1], max(reached) + margin)
        _check_folds(cut, clearance, np.linspace(start, end_t, 1001))
        levels, counts = np.unique(cut.knots[cut.degree + 1 : -cut.degree - 1], return_counts=True)
        joints = [
            (float(place), max(cut.degree - int(count) - 1, 0)) for place, count in zip(levels, counts, strict=True)
        ]
        begin = knots_with_joints(np.repeat([start, end_t], DEGREE + 1), DEGREE, joints)
        knots = refined(
            begin, lambda on, at: length(np.real(fitted(on)(at) - points(at))) / (REACHED * chord), MOST_POLES
        )
    return fitted(knots)


def _check_folds(cut: Curve, clearance: Clearance, t: Reals) -> None:
    real = clearance.real()
    name, distance = clearance.name, float(np.max(real.distance(np.array([0.0, 1.0]))))
    slope, bend = np.real(cut.derivative(t)), np.real(cut.derivative(t, 2))
    curvature = float(np.max(clearance.inward * cross2(slope, bend) / length(slope) ** 3))
    if curvature * distance >= 1.0:
        raise DesignError(
            f"{name}: the cut's radius of curvature towards the blade is {1.0 / curvature:.4g} m, and the surface at "
            f"{distance:.4g} m from it folds over: lower {name}, or give a smoother cut"
        )
