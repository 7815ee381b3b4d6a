"""Two figures of Tortora et al. 2023 that segmented airfoils miss, and why.

`bend`: table 15, the lift of the six segments of NACA 23012 with its nose at 4 and its tail at -15 deg, by XFOIL, with
the tangents at the cuts turned by a share of the edges' angles, and with the two shares, scale factors at the cuts and
angle of attack that come nearest to the table. The design's morph keeps tangents and curvatures at the cuts.

`joints`: S809 at the cuts 0.3 and 0.7 with its joints held at what a spline through its table gives: of each segment
the least largest distance of the points, over both scale factors and the inner control point, by differential
evolution, which knows nothing of the fit's starts and derivatives. Each segment is then on its own.
"""

import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
from scipy.optimize import differential_evolution, minimize
from scipy.spatial import cKDTree

import bladewright as bw
from bladewright.fitting.families import segmented
from bladewright.fitting.families.first_parts import first_part
from bladewright.fitting.families.segmented import contour_shape
from bladewright.nurbs.basis import basis
from bladewright.section.laws import Span
from bladewright.section.segmented.part import side_joints
from bladewright.section.segmented.segment import DEGREE, control_points, segment_knots

TABLE_15 = np.array([0.1106, 0.4239, 0.5472, 0.1638, 0.1535, 0.1109])
"""cl_i of the segments, as they are numbered there"""
S809 = Path(__file__).parents[1] / "tests/fitting/airfoils/s809.dat"
FINE = np.linspace(0.0, 1.0, 600)
SPAN = Span(np.zeros(1))


def bend():
    """Lift of the segments, and the largest difference from table 15."""
    design = bw.read_design(Path(__file__).parents[1] / "src/bladewright/examples/morphing-airfoil.toml")
    design = design.changed("section.morph", bw.Morph(leading_edge=4.0, trailing_edge=-15.0))

    def polar(nose_share, tail_share, nose_scale=1.0, tail_scale=1.0, level=1.0):
        """That of the design with tangents at the cuts turned, scale factors there multiplied, and its angle."""
        turned = {}
        for name in ("upper", "lower"):
            side = getattr(design.section, name)
            turned[f"section.{name}.front_joint.angle"] = side.front_joint.angle + nose_share * 4.0
            turned[f"section.{name}.rear_joint.angle"] = side.rear_joint.angle - tail_share * 15.0
            turned[f"section.{name}.leading_edge.rear_scale"] = side.leading_edge.rear_scale * nose_scale
            turned[f"section.{name}.trailing_edge.front_scale"] = side.trailing_edge.front_scale * tail_scale
        alpha = 4.0 - level * design.section.stagger_angle
        return bw.polar(design.changed(turned).build(), 3.5e6, alpha)

    def row(name, given):
        found = polar(*given)
        lift = found.segments(found.alpha[0]).lift_pressure[:6]
        figures = " | ".join(f"{each:.4f}" for each in lift)
        off = float(np.max(np.abs(lift - TABLE_15)))
        print(f"| {name} | {found.cl[0]:.4f} | {found.cd[0]:.5f} | {figures} | {off:.4f} |", flush=True)

    def miss(given):
        try:
            found = polar(*given)
        except bw.BladewrightError:
            return 1.0
        return float(np.sum((found.segments(found.alpha[0]).lift_pressure[:6] - TABLE_15) ** 2))

    print("| tangents turned by | cl | cd | 1 | 2 | 3 | 4 | 5 | 6 | largest difference |\n" + "|---" * 10 + "|")
    for share in (0.0, 0.25, 0.5, 0.75, 1.0):
        row(f"{share:g} of the angles", (share, share))
    start = np.array([0.3, 0.4, 0.8, 0.8, 0.5])
    simplex = [start, *(start + step for step in np.diag([0.5, -0.2, -0.3, 0.4, 0.5]))]
    found = minimize(miss, start, method="Nelder-Mead", options={"maxfev": 150, "initial_simplex": simplex})
    row("nearest: shares, scales, level " + ", ".join(f"{each:.2f}" for each in found.x), found.x)


def joints():
    """The least largest distance of each segment, of the chord, by the window over which joints are estimated."""
    points = np.loadtxt(S809, skiprows=1)
    shape = contour_shape(points)
    level = (points - shape.start) @ rotation(shape.stagger) / shape.chord
    nose = int(np.argmin(level[:, 0]))
    names = ("leading_edge", "central_box", "trailing_edge")
    print("| window | " + " | ".join(f"{side} {name}" for side in ("upper", "lower") for name in names) + " |")
    print("|---" * 7 + "|")
    for window in (0.02, segmented.WINDOW, 0.1):
        segmented.WINDOW = window
        part = first_part(segmented.structures(shape)[0], shape)
        found = []
        for sign, table in ((1.0, level[: nose + 1]), (-1.0, level[nose:])):
            for ends in pairwise(side_joints(part, sign, SPAN)):
                low, high = (float(each.point[0, 0]) for each in ends)
                own = table[(table[:, 0] >= low - 1e-9) & (table[:, 0] <= high + 1e-9)]
                found.append(f"{best(ends, own):.1e}")
        print(f"| {window:g} | " + " | ".join(found) + " |", flush=True)


def best(ends, points):
    """The least largest distance of points from a segment between two joints."""
    kept = [1 + (each.direction is not None) + (each.curvature is not None) for each in ends]
    rows = basis(segment_knots(sum(kept) + 1), DEGREE, FINE)
    start, end = (each.point[0] for each in ends)
    distance = float(np.hypot(*(end - start)))

    def largest(x):
        tips = [joint.end(np.array([distance]), np.array([scale])) for joint, scale in zip(ends, x[:2], strict=True)]
        curve = rows @ control_points(tips[0], x[2:].reshape(1, 1, 2), tips[1])[0]
        near = cKDTree(curve).query(points)[1].clip(1, len(curve) - 2)
        along = curve[near + 1] - curve[near - 1]
        off = points - curve[near]
        return float(np.max(np.abs(along[:, 0] * off[:, 1] - along[:, 1] * off[:, 0]) / np.hypot(*along.T)))

    height = (start[1] + end[1]) / 2.0
    bounds = [(0.02, 6.0), (0.02, 6.0), (start[0], end[0]), (height - 0.1, height + 0.1)]
    return differential_evolution(largest, bounds, seed=1, popsize=15, maxiter=100, tol=1e-6, polish=False).fun


def rotation(angle):
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


if __name__ == "__main__":
    {"bend": bend, "joints": joints}[sys.argv[1]]()
