"""A centrifugal compressor impeller: exit radius and backsweep, measured on the built surfaces."""

import numpy as np
from _common import example, export

blade = example("centrifugal-impeller").build()
export(blade.design, blade)

v = np.linspace(0.0, 1.0, 21)
_, y, z = np.moveaxis(blade.surfaces["upper"](1.0, v), -1, 0)
radius = np.hypot(y, z)
# at its very edge a side runs across the camber; with the exit radial, the camber lies in the plane x = const
_, dy, dz = np.moveaxis(blade.surfaces["upper"].derivative(1.0, v, du=1), -1, 0)
outward, around = (y * dy + z * dz) / radius, (z * dy - y * dz) / radius
backsweep = np.degrees(np.arctan2(outward, -around))
print(f"exit radius {1e3 * radius.mean():.3f} mm, backsweep {backsweep.mean():.3f} deg")

# the trailing edge lies on a cylinder of 100 mm, and the blade leaves 35 deg against the rotation, towards +theta
assert np.max(np.abs(radius - 0.1)) < 1e-7
assert np.max(np.abs(backsweep + 35.0)) < 0.01
