"""Kinks of the duct: where curvature or direction of hub or shroud jumps, as where straights and arcs meet.

A patch of a wall can follow a kink where that is a line u = const of the patch, with a knot there; past a round edge it
is one only where the skew of the cross-lines has faded out before it.
"""

import numpy as np

from bladewright.blade.flow_path.meridional_curve import real_first
from bladewright.domain.camber_lines import CamberLines
from bladewright.domain.duct import Duct
from bladewright.domain.walls import EASE
from bladewright.numerics.elementary import cross2, length, unit
from bladewright.nurbs.basis import Reals

JUMP = 1e-3
"""Jump of the curvature, times the blade's mean meridional length, or of the direction [rad], from which a joint is a
kink: a smaller one of the curvature moves a wall between knots a thirtieth of that length apart by 1e-8 of it, a tenth
of what walls may be off."""
BESIDE = 1e-9
"""Distance from a joint, of the duct's extent in u, at which the curvature before and behind it is taken."""


def kinks(duct: Duct, row: int, *, corners: bool = False) -> Reals:
    """u at which curvature or direction of hub (row 0) or shroud (1) jumps between inlet and outlet.

    With `corners` those alone at which the direction does.
    """
    joints, step = duct.joints_within(), BESIDE * (duct.high - duct.low)
    directions, curvatures = [], []
    for side in (-step, step):
        powers = real_first(duct.stream_polynomials(np.array([float(row)]), joints + side), 4)[0]
        slope, bend = powers[:, 1], 2.0 * powers[:, 2]
        directions.append(unit(slope))
        curvatures.append(cross2(slope, bend) / length(slope) ** 3)
    turned = np.square(cross2(*directions)) > JUMP**2
    bent = np.square(curvatures[1] - curvatures[0]) * duct.length**2 > JUMP**2
    return joints[turned if corners else turned | bent]


def kink_shares(camber: CamberLines, edge: int, *, corners: bool = False) -> Reals:
    """Shares (k,) of the way in m' from an edge to inlet or outlet at which hub or shroud has a kink, increasing.

    With `corners` those alone at which the direction jumps. The stations of `camber` begin on the hub and end on the
    shroud.
    """
    duct = camber.duct
    end = duct.high if edge else duct.low
    found = []
    for row, wall in ((0, 0), (1, -1)):
        line = camber.lines.rows([wall])
        start = real_first(camber.edge_points(edge), 3)[wall, 0, 0]
        places = real_first(line.abscissa(np.append(kinks(duct, row, corners=corners), end)), 2)[0]
        shares = (places[:-1] - start) / (places[-1] - start)
        found.append(shares[(shares > 0.0) & (shares < 1.0)])
    return np.sort(np.concatenate(found))


def skew_reach(shares: Reals, least: float) -> float:
    """The share of the way from an edge over which the skew of cross-lines fades: up to a kink, but `least` at least.

    The whole way where no kink lies far enough away.
    """
    far = shares[shares >= least]
    return float(far[0]) if len(far) else 1.0


def fade_joints(reach: float) -> Reals:
    """Shares of the way from an edge at which the fading skew loses its third derivative."""
    return np.array([reach * (1.0 - EASE), reach]) if reach < 1.0 else np.empty(0)
