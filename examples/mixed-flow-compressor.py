"""A mixed-flow compressor impeller on meanlines of given curvature: its exit, and the angles at it."""

import numpy as np
from _common import example, export

blade = example("mixed-flow-compressor").build()
export(blade.design, blade)

v = np.linspace(0.0, 1.0, 21)
x, y, z = np.moveaxis(blade.surfaces["upper"](1.0, v), -1, 0)
radius = np.hypot(y, z)
cone = np.degrees(np.arctan2(x[0] - x[-1], radius[-1] - radius[0]))
backsweep = [np.degrees(blade.section(at).metal_angle_out) for at in (0.0, 0.5, 1.0)]
exit_radii = f"{1e3 * radius[0]:.2f} to {1e3 * radius[-1]:.2f} mm"
print(f"exit from {exit_radii}, {cone:.1f} deg to the radius; metal angle {backsweep[1]:.4f} deg")

assert np.max(np.abs(np.array(backsweep) + 32.0)) < 1e-4
assert 45.0 < cone < 60.0
