"""A wedge diffuser: how straight its flanks are in the conformal plane, and the angle between them."""

import numpy as np
from _common import example, export

blade = example("wedge-diffuser").build()
export(blade.design, blade)

directions, off = [], 0.0
for side in ("upper", "lower"):
    x, y, z = np.moveaxis(blade.surfaces[side](np.linspace(0.15, 0.8, 301), np.full(301, 0.5)), -1, 0)
    # on a disk the conformal length is the logarithm of the radius
    plane = np.column_stack([np.log(np.hypot(y, z)), np.unwrap(np.arctan2(y, z))])
    slope, start = np.polyfit(*plane.T, 1)
    directions.append(np.degrees(np.arctan(slope)))
    off = max(off, np.max(np.abs(plane[:, 1] - np.polyval((slope, start), plane[:, 0]))))
wedge = abs(directions[0] - directions[1])
print(f"flanks at {directions[0]:.5f} and {directions[1]:.5f} deg, off a straight line by {off:.1e} rad")

assert abs(wedge - 7.0) < 1e-4
assert off < 1e-6
