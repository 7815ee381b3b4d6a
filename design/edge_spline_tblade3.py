"""Which conditions T-Blade3's leading edge spline meets, read off the control points that it printed.

Version 1.2.2, case LE_spline_turb4, two sections; the frame has its origin at the leading edge and its axis through the
middle of the two contacts. Measured:

* The contacts are points of a section at u = 0.02244, a station of its own, the last before the half thickness without
  multiplier passes half the edge's thickness; but of one whose meanline has the scale kappa 1 (7e-17), where it is
  15.07 and 11.19. They lie 9.2e-4 and 7.2e-4 chords off the section, so the edge does not meet what it belongs to.
* The tip, in the middle of the third segment, stands (1 + elongation) times the contact's ordinate before the contacts:
  1e-17. The fourth and sixth control points leave the fifth at half the vertex angle by `distance` times the way from
  the tip to the contact: 1e-16.
* At the contacts y'/x' is dy/dx (1e-10) and y''/x'' is y_uu / x_u^2 (4e-5), of seven points 1e-6 apart in u.
* y'''/x''' would then be y_uuu / x_u^3, which is 285, -290, 532 and -545. It is 218, -356, 463 and -845: third
  differences of numbers rounded to 7e-18 over (2e-6)^3. That rounding decides much of the shape: the third control
  point stands 1.15 of the contact's ordinate high on one side, the seventh 0.99 on the other.
* Sixteen of the eighteen equations are these. The two left make the third control point's ordinate a blend of its
  neighbours', c of the second and 1 - c of the fourth, and the seventh's likewise. The factors are none of the file's
  (0.6): T-Blade3 seeks them between 0 and 4 by golden sections, to 1e-5, so that the polygon turns least. They are
  0.974 and 0.858 in the first section, 2.146 and 0.960 in the second.

So all equations are known, and their numbers are not: with y''' as printed, the exact ratio changes x''' by 6e-5 and so
one of four control points by 7e-6 at least, before the search for the factors starts from it. To agree within 1e-6 a
program must round as T-Blade3 does. `bladewright.section.edge_spline` keeps the nine control points, droop and
elongation, and matches derivatives by s.

    python design/edge_spline_tblade3.py
"""

from pathlib import Path

import numpy as np

from bladewright.section.chord_spline import ChordSpline, segments
from bladewright.section.laws import Span
from bladewright.section.meanline import CurvedMeanline
from bladewright.section.thickness.quartic import QuarticSpline

OUTPUT = Path(__file__).parents[2] / "shared" / "data" / "tblade3" / "LE_spline_turb4_v1.2.2" / "output"
ELONGATION, VERTEX_DISTANCE = -0.10, 0.35
SECTIONS = {1: (0.13, 0.08, 0.05), 2: (0.08, 0.07, 0.05)}
"""maximum, leading and trailing edge thickness"""
FIRST = np.array([-147, 360, -450, 400, -225, 72, -10]) / 60.0
SECOND = np.array([812, -3132, 5265, -5080, 2970, -972, 137]) / 180.0
THIRD = np.array([-49, 232, -461, 496, -307, 104, -15]) / 8.0


def printed(n):
    """Control points (9, 2), and seven points (7, 2) from either contact on."""
    lines = [line.split() for line in (OUTPUT / f"le_def.{n}.NASA.txt").read_text().splitlines() if line.strip()]
    controls = np.loadtxt(OUTPUT / f"le_CP.{n}.NASA.txt", skiprows=1)
    return controls, np.array(lines[1:8], float), np.array(lines[9:16], float)


def section(n, u, scale):
    """Both sides (k, 2) at u on a meanline of the case's slope at the leading edge and a second derivative -scale S."""
    maximum, leading, trailing = SECTIONS[n]
    law = QuarticSpline(
        maximum_thickness=maximum,
        maximum_thickness_at=0.3,
        leading_edge_thickness=leading,
        trailing_edge_thickness=trailing,
    )
    multiplier = ChordSpline(
        places=np.array([[0.0, 0.05, 0.08, 0.25, 0.5, 0.7, 0.9, 1.0]]),
        values=np.array([[0.0, 0.2, 0.4, 1.0, 0.6, 0.15, 0.05, 0.0]]),
    )
    half = (law.at(Span(np.zeros(1))).half_at(u) * (1.0 + multiplier.derivatives(u)[0]))[0]
    line = CurvedMeanline(
        places=np.array([[0.0, 0.03, 0.2, 0.5, 0.8, 1.0]]),
        values=np.array([[0.0, 0.5, 0.25, 0.1, 0.05, 0.0]]),
        camber=np.zeros(1),
    )
    second, first, *_ = (each[0] for each in line.integrals(u))
    slope_in = np.loadtxt(OUTPUT / f"curvature_data.{n}.NASA")[0, 2]
    slope, v = slope_in - scale * first, slope_in * u - scale * second
    across = half / np.sqrt(1.0 + slope**2)
    return np.stack([u - slope * across, v + across], -1), np.stack([u + slope * across, v - across], -1)


for n in SECTIONS:
    controls, upper, lower = printed(n)
    u = 0.5 * (upper + lower)[:, 0]
    for scale in (1.0, {1: 15.0693, 2: 11.1915}[n]):
        found = section(n, u, scale)
        off = max(np.max(np.abs(found[0] - upper)), np.max(np.abs(found[1] - lower)))
        print(f"section {n}: contacts at u = {u[0]:.8f}, kappa {scale:g}: {off:.1e} off")
    middle = 0.5 * (upper + lower)[0]
    length = np.hypot(*middle)
    turn = np.array([middle, [-middle[1], middle[0]]]).T / length
    controls, upper, lower = controls @ turn, upper @ turn, lower @ turn
    exact = [side @ turn for side in section(n, u[0] + 2e-4 * (np.arange(7.0) - 6.0), 1.0)]
    tip = [np.polyval(segments(controls[:, k])[2][::-1], 0.5) for k in (0, 1)]
    way = np.hypot((1.0 + ELONGATION) * upper[0, 1], upper[0, 1])
    print("  tip off by", tip[0] - (length - (1.0 + ELONGATION) * upper[0, 1]), tip[1])
    print("  vertex distance", np.hypot(*(controls[3] - controls[4])) / way - VERTEX_DISTANCE)
    for side, points, smooth, row in (("upper", upper, exact[0], controls), ("lower", lower, exact[1], controls[::-1])):
        step = (points[6, 0] - points[0, 0]) / 6.0
        x, y = segments(row[:, 0])[0], segments(row[:, 1])[0]
        # backwards over steps of 2e-4, where third differences are not rounding
        third = (THIRD @ smooth[::-1, 1]) / (FIRST @ smooth[::-1, 0]) ** 3
        print(f"  {side}: dy/dx {FIRST @ points[:, 1] / step - y[1] / x[1]:.1e}", end=", ")
        print(f"second {(SECOND @ points[:, 1] / step**2) / (y[2] / x[2]) - 1.0:.1e}", end=", ")
        print(f"third {y[3] / x[3]:.1f} where the section has {third:.1f}", end=", ")
        print(f"third control point {row[2, 1] / points[0, 1]:.4f} of the contact's ordinate")
    blends = [(row[2, 1] - row[3, 1]) / (row[1, 1] - row[3, 1]) for row in (controls, controls[::-1])]
    print(f"  blends {blends[0]:.4f} and {blends[1]:.4f}")
